// SPDX-License-Identifier: Apache-2.0
// OpenEXR behind image_file.h. The library throws on damaged files; every call stands inside a try.
#include "core/base/atomic_file.h"
#include "core/base/image_file.h"
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <algorithm>
#include <cassert>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <stdexcept>

namespace lightloom {
namespace {

constexpr int kMostSide = 16384;
constexpr std::int64_t kMostPixels = 64'000'000;
constexpr std::uint64_t kMostBytes = 1ull << 30;
constexpr std::size_t kMostChannels = 256;

class MemoryOut final : public Imf::OStream {
public:
    MemoryOut() : Imf::OStream("memory") {}
    void write(const char* bytes, int count) override
    {
        const std::size_t end = position_ + static_cast<std::size_t>(count);
        if (end > bytes_.size()) bytes_.resize(end);
        std::memcpy(bytes_.data() + position_, bytes, static_cast<std::size_t>(count));
        position_ = end;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }
    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

private:
    std::vector<std::uint8_t> bytes_;
    std::size_t position_ = 0;
};

class MemoryIn final : public Imf::IStream {
public:
    explicit MemoryIn(const std::vector<std::uint8_t>& bytes) : Imf::IStream("memory"), bytes_(bytes) {}
    bool read(char* into, int count) override
    {
        const auto wanted = static_cast<std::size_t>(count);
        if (count < 0 || position_ > bytes_.size() || bytes_.size() - position_ < wanted) {
            throw std::runtime_error("the file ends too early");
        }
        std::memcpy(into, bytes_.data() + position_, wanted);
        position_ += wanted;
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }
    void clear() override {}

private:
    const std::vector<std::uint8_t>& bytes_;
    std::uint64_t position_ = 0;
};

/// Before a frame buffer exists OpenEXR allocates tables by the size the header promises.
void limitOpenExr()
{
    static const bool once = [] {
        Imf::Header::setMaxImageSize(kMostSide, kMostSide);
        Imf::Header::setMaxTileSize(kMostSide, kMostSide);
        return true;
    }();
    static_cast<void>(once);
}

std::string channelName(const std::string& layer, char channel)
{
    return layer.empty() ? std::string(1, channel) : layer + "." + channel;
}

/// Channels of a file by layer. `first` maps a pixel's R (or lone Y) channel; the others follow.
struct Channels {
    std::map<std::string, int> rgb; // bit 0 R, 1 G, 2 B
    bool hasY = false;
};

Result<Channels> channelsOf(const Imf::Header& header)
{
    Channels found;
    std::size_t count = 0;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++count) {
        const std::string name = c.name();
        const std::size_t dot = name.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : name.substr(0, dot);
        const std::string last = dot == std::string::npos ? name : name.substr(dot + 1);
        if (name == "Y") found.hasY = true;
        const std::size_t bit = last.size() == 1 ? std::string("RGB").find(last[0]) : std::string::npos;
        if (bit == std::string::npos) continue;
        if (c.channel().xSampling != 1 || c.channel().ySampling != 1) {
            return Error{Error::Kind::unsupported, fmt::format("channel {} is subsampled", name)};
        }
        found.rgb[layer] |= 1 << bit;
    }
    if (count > kMostChannels) {
        return Error{Error::Kind::badInput, fmt::format("{} channels; at most {} are read", count, kMostChannels)};
    }
    std::erase_if(found.rgb, [](const auto& layer) { return layer.second != 7; });
    if (found.rgb.empty() && !found.hasY) {
        return Error{Error::Kind::badInput, "no layer has R, G and B"};
    }
    return found;
}

Imf::Slice sliceOf(FloatImage& image, int channel, Imath::Box2i window)
{
    // FrameBuffer counts from pixel (0,0), which may lie outside the window
    const std::size_t pixel = sizeof(glm::vec3), row = pixel * static_cast<std::size_t>(image.width);
    const auto offset = static_cast<std::ptrdiff_t>(window.min.x) * static_cast<std::ptrdiff_t>(pixel) +
                        static_cast<std::ptrdiff_t>(window.min.y) * static_cast<std::ptrdiff_t>(row);
    char* base = reinterpret_cast<char*>(image.pixels.data()) + channel * static_cast<std::ptrdiff_t>(sizeof(float));
    return {Imf::FLOAT, base - offset, pixel, row};
}

Result<LayeredImage> decode(const std::vector<std::uint8_t>& bytes)
{
    limitOpenExr();
    MemoryIn stream(bytes);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = file.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > kMostSide || height > kMostSide || width * height > kMostPixels) {
        return Error{Error::Kind::badInput,
                     fmt::format("it says {} x {} pixels; up to {} a side and {} in all are read", width, height,
                                 kMostSide, kMostPixels)};
    }
    const Result<Channels> channels = channelsOf(file.header());
    if (!channels) return channels.error();

    LayeredImage image;
    for (const auto& [layer, bits] : channels->rgb) {
        image.layers.push_back({layer, FloatImage(static_cast<int>(width), static_cast<int>(height))});
    }
    const bool isGrey = !channels->rgb.contains("") && channels->hasY;
    if (isGrey) image.layers.push_back({"", FloatImage(static_cast<int>(width), static_cast<int>(height))});
    Imf::FrameBuffer target;
    for (ImageLayer& layer : image.layers) {
        const bool fromY = isGrey && layer.name.empty();
        for (int c = 0; c < (fromY ? 1 : 3); ++c) {
            target.insert(fromY ? "Y" : channelName(layer.name, "RGB"[c]), sliceOf(layer.image, c, window));
        }
    }
    file.setFrameBuffer(target);
    file.readPixels(window.min.y, window.max.y);
    if (isGrey) {
        for (glm::vec3& p : image.layers.back().image.pixels) p = glm::vec3(p.x);
    }
    for (auto a = file.header().begin(); a != file.header().end(); ++a) {
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute());
        if (text) image.notes.emplace_back(a.name(), text->value());
    }
    return image;
}

} // namespace

const FloatImage* LayeredImage::find(const std::string& name) const
{
    for (const ImageLayer& layer : layers) {
        if (layer.name == name) return &layer.image;
    }
    return nullptr;
}

Result<Done> writeExr(const std::filesystem::path& path, const LayeredImage& image)
{
    assert(!image.layers.empty());
    const FloatImage& first = image.layers.front().image;
    try {
        Imf::Header header(first.width, first.height);
        header.compression() = Imf::ZIP_COMPRESSION;
        Imf::FrameBuffer source;
        for (const ImageLayer& layer : image.layers) {
            assert(layer.image.isSameSize(first));
            for (int c = 0; c < 3; ++c) {
                const std::string name = channelName(layer.name, "RGB"[c]);
                header.channels().insert(name, Imf::Channel(Imf::FLOAT));
                // slices are never const in OpenEXR; writing only reads them
                source.insert(name, sliceOf(const_cast<FloatImage&>(layer.image), c, header.dataWindow()));
            }
        }
        for (const auto& [name, text] : image.notes) header.insert(name, Imf::StringAttribute(text));
        MemoryOut stream;
        {
            Imf::OutputFile file(stream, header, 0);
            file.setFrameBuffer(source);
            file.writePixels(first.height);
        } // the table of line offsets is written by the destructor
        return writeFile(path, std::span(stream.bytes()));
    } catch (const std::bad_alloc&) {
        return Error{Error::Kind::outOfMemory, fmt::format("{}: no memory left to write it", path.string())};
    } catch (const std::exception& e) {
        return Error{Error::Kind::io, fmt::format("cannot write {}: {}", path.string(), e.what())};
    }
}

Result<LayeredImage> readExr(const std::filesystem::path& path)
{
    const Result<std::vector<std::uint8_t>> bytes = readFile(path, kMostBytes);
    if (!bytes) return bytes.error();
    try {
        Result<LayeredImage> image = decode(*bytes);
        if (!image) return image.error().in(path.string());
        return image;
    } catch (const std::bad_alloc&) {
        return Error{Error::Kind::badInput,
                     fmt::format("{}: its header asks for more memory than there is", path.string())};
    } catch (const std::exception& e) {
        std::string why = e.what();
        std::replace(why.begin(), why.end(), '\n', ' ');
        return Error{Error::Kind::badInput, fmt::format("{} is not a readable EXR file: {}", path.string(), why)};
    }
}

} // namespace lightloom
