// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_materials.h"
#include "core/scene/gltf_json.h"
#include "core/scene/image_decode.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <tiny_gltf.h>

namespace lightloom {
namespace {

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 28; ///< all images together: 1 GiB decoded

const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name)
{
    const auto found = extensions.find(name);
    return found == extensions.end() || !found->second.IsObject() ? nullptr : &found->second;
}

/// Decodes each picture once, when a texture first asks.
class Images {
public:
    Images(const CheckedGltf& checked, const SceneFolder& folder, Scene& scene)
        : checked_(checked), folder_(folder), scene_(scene)
    {
    }

    /// Index into Scene::images.
    Result<int> get(int source)
    {
        const auto known = indices_.find(source);
        if (known != indices_.end()) return known->second;
        const GltfImageSource& image = checked_.images[static_cast<std::size_t>(source)];
        Result<Image> decoded = decode(image);
        if (!decoded) return decoded.error().in(fmt::format("image \"{}\"", image.name));
        decoded->name = image.name;
        scene_.images.push_back(*std::move(decoded));
        return indices_[source] = static_cast<int>(scene_.images.size()) - 1;
    }

private:
    Result<Image> decode(const GltfImageSource& image)
    {
        std::vector<std::uint8_t> file;
        std::span<const std::uint8_t> bytes = image.bytes;
        if (!image.uri.empty()) {
            Result<std::vector<std::uint8_t>> read = folder_.read(image.uri, GltfLimits{}.fileBytes);
            if (!read) return read.error();
            file = *std::move(read);
            bytes = file;
        }
        const Result<ImageSize> size = imageSize(bytes);
        if (!size) return size.error();
        pixels_ += size->pixels();
        if (pixels_ > kMostPixels) {
            return Error{Error::Kind::outOfMemory,
                         fmt::format("the scene's images hold more than {} pixels; scale them down", kMostPixels)};
        }
        return decodeImage(bytes);
    }

    const CheckedGltf& checked_;
    const SceneFolder& folder_;
    Scene& scene_;
    std::map<int, int> indices_;
    std::uint64_t pixels_ = 0;
};

class MaterialReader {
public:
    MaterialReader(const tinygltf::Model& model, Images& images, GltfWarnings& warnings)
        : model_(model), images_(images), warnings_(warnings)
    {
    }

    Result<Material> read(const tinygltf::Material& from, bool withTextures)
    {
        Material to;
        to.name = plainName(from.name);
        readFactors(from, to);
        readExtensions(from, to);
        if (!isFinite(to.emission)) {
            return Error{Error::Kind::badInput, fmt::format("material \"{}\": it is too bright for a float", to.name)};
        }
        if (!withTextures) return to;
        const auto& pbr = from.pbrMetallicRoughness;
        for (const Result<Done>& read : {readTexture(pbr.baseColorTexture, to.baseColorTexture),
                                         readTexture(pbr.metallicRoughnessTexture, to.metallicRoughnessTexture),
                                         readTexture(from.normalTexture, to.normalTexture),
                                         readTexture(from.emissiveTexture, to.emissionTexture)}) {
            if (!read) return read.error().in(fmt::format("material \"{}\"", to.name));
        }
        return to;
    }

private:
    void readFactors(const tinygltf::Material& from, Material& to)
    {
        const auto& pbr = from.pbrMetallicRoughness;
        if (pbr.baseColorFactor.size() == 4) {
            for (int c = 0; c < 4; ++c) {
                to.baseColor[c] = static_cast<float>(pbr.baseColorFactor[static_cast<std::size_t>(c)]);
            }
        }
        to.metallic = static_cast<float>(pbr.metallicFactor);
        to.roughness = static_cast<float>(pbr.roughnessFactor);
        to.normalScale = static_cast<float>(from.normalTexture.scale);
        const tinygltf::Value* bright = extension(from.extensions, "KHR_materials_emissive_strength");
        const double strength = bright != nullptr ? gltfNumber(*bright, "emissiveStrength", 1.0) : 1.0;
        if (from.emissiveFactor.size() == 3) {
            for (int c = 0; c < 3; ++c) {
                to.emission[c] = static_cast<float>(from.emissiveFactor[static_cast<std::size_t>(c)] * strength);
            }
        }
        to.doubleSided = from.doubleSided;
        to.alphaCutoff = static_cast<float>(from.alphaCutoff);
        if (from.alphaMode == "MASK") to.alpha = Material::Alpha::mask;
        if (from.alphaMode == "BLEND") {
            to.alpha = Material::Alpha::blend;
            warnings_.add("blended transparency (alphaMode BLEND) stops light as an opaque surface does");
        }
    }

    void readExtensions(const tinygltf::Material& from, Material& to)
    {
        if (const auto* glass = extension(from.extensions, "KHR_materials_transmission")) {
            to.transmission = static_cast<float>(gltfNumber(*glass, "transmissionFactor", 0.0));
            if (glass->Has("transmissionTexture")) {
                warnings_.add("textures of KHR_materials_transmission are ignored, the factor counts");
            }
        }
        if (const auto* index = extension(from.extensions, "KHR_materials_ior")) {
            to.ior = static_cast<float>(gltfNumber(*index, "ior", 1.5));
        }
        if (const auto* volume = extension(from.extensions, "KHR_materials_volume")) {
            to.thickness = static_cast<float>(gltfNumber(*volume, "thicknessFactor", 0.0));
            to.attenuationDistance = static_cast<float>(gltfNumber(*volume, "attenuationDistance", 0.0));
            if (volume->Has("thicknessTexture")) {
                warnings_.add("textures of KHR_materials_volume are ignored: light takes the way through the mesh");
            }
            const tinygltf::Value& colour = volume->Get("attenuationColor");
            for (int c = 0; c < 3 && colour.IsArray(); ++c) {
                to.attenuationColor[c] = static_cast<float>(colour.Get(c).GetNumberAsDouble());
            }
        }
        warnOfGlass(to);
    }

    void warnOfGlass(const Material& glass)
    {
        if (!mayTransmit(glass)) return;
        if (glass.roughness >= kMirrorRoughness) {
            warnings_.add("rough glass (transmission with a roughness) is taken as smooth");
        }
        if (glass.ior > 0.0f && glass.ior < 1.0f) {
            warnings_.add("an ior below 1 bends light away from the normal on its way in, as air in water does");
        }
    }

    /// `Info` is one of tinygltf's texture references, which share their members but no base.
    template<class Info>
    Result<Done> readTexture(const Info& from, Texture& to)
    {
        if (from.index < 0) return Done{};
        const tinygltf::Texture& texture = model_.textures[static_cast<std::size_t>(from.index)];
        if (texture.source < 0) {
            warnings_.add("textures without a PNG or JPEG image are ignored");
            return Done{};
        }
        double uvSet = from.texCoord;
        if (const auto* transform = extension(from.extensions, "KHR_texture_transform")) {
            uvSet = gltfNumber(*transform, "texCoord", uvSet);
            to.rotation = static_cast<float>(gltfNumber(*transform, "rotation", 0.0));
            to.offset = pair(transform->Get("offset"), to.offset);
            to.scale = pair(transform->Get("scale"), to.scale);
        }
        if (uvSet > 1.0) {
            warnings_.add("textures on TEXCOORD_2 and beyond are ignored");
            return Done{};
        }
        to.uvSet = static_cast<int>(uvSet);
        if (texture.sampler >= 0) {
            const tinygltf::Sampler& sampler = model_.samplers[static_cast<std::size_t>(texture.sampler)];
            to.wrapS = wrap(sampler.wrapS);
            to.wrapT = wrap(sampler.wrapT);
            to.smooth = sampler.magFilter != TINYGLTF_TEXTURE_FILTER_NEAREST;
        }
        const Result<int> image = images_.get(texture.source);
        if (!image) return image.error();
        to.image = *image;
        return Done{};
    }

    static glm::vec2 pair(const tinygltf::Value& value, glm::vec2 otherwise)
    {
        if (!value.IsArray()) return otherwise;
        return {static_cast<float>(value.Get(0).GetNumberAsDouble()),
                static_cast<float>(value.Get(1).GetNumberAsDouble())};
    }

    static Texture::Wrap wrap(int mode)
    {
        if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Texture::Wrap::clamp;
        return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Texture::Wrap::mirror : Texture::Wrap::repeat;
    }

    static bool isFinite(glm::vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

    const tinygltf::Model& model_;
    Images& images_;
    GltfWarnings& warnings_;
};

} // namespace

Result<Done> readMaterials(const tinygltf::Model& model, const CheckedGltf& checked, const SceneFolder& folder,
                           const std::vector<bool>& used, Scene& scene, GltfWarnings& warnings)
{
    Images images(checked, folder, scene);
    MaterialReader reader(model, images, warnings);
    for (std::size_t i = 0; i < model.materials.size(); ++i) {
        Result<Material> material = reader.read(model.materials[i], used[i]);
        if (!material) return material.error();
        scene.materials.push_back(*std::move(material));
    }
    if (used.back()) {
        scene.materials.emplace_back().name = "default";
        warnings.add("meshes without a material get glTF's default: white, metallic, rough");
    }
    return Done{};
}

} // namespace lightloom
