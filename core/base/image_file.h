// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/image.h"
#include "core/base/result.h"
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Pictures in files: OpenEXR for numbers, PNG for people. Files are written whole or not at all
/// (core/base/atomic_file) and read with limits, since a header can promise any size: 16384 pixels a side, 64 million
/// in all, 1 GiB of file.
namespace lightloom {

/// Name and value of a note in the file's header.
using ImageNotes = std::vector<std::pair<std::string, std::string>>;

/// One RGB picture inside an EXR file: channels "name.R", "name.G", "name.B"; "" is the plain picture.
struct ImageLayer {
    std::string name;
    FloatImage image;
};

/// An EXR file: layers of one size in a single part, because other tools show only the first of several parts.
struct LayeredImage {
    std::vector<ImageLayer> layers;
    ImageNotes notes;                                                    ///< string attributes
    [[nodiscard]] const FloatImage* find(const std::string& name) const; ///< null if there is no such layer
};

/// 32-bit float channels, zip compressed. All layers must have the same size (asserted).
Result<Done> writeExr(const std::filesystem::path& path, const LayeredImage& image);
/// Every layer that has R, G and B; a file with a lone Y gives a grey plain layer. Values as stored, NaN included.
/// Errors: not an EXR, damaged, over the limits, deep or subsampled, no colour in it.
[[nodiscard]] Result<LayeredImage> readExr(const std::filesystem::path& path);

/// 8-bit sRGB; notes become tEXt chunks (Latin-1).
Result<Done> writePng(const std::filesystem::path& path, const ByteImage& image, const ImageNotes& notes = {});
/// Any PNG, converted to 8-bit sRGB by the file's own gamma; transparency over black.
[[nodiscard]] Result<ByteImage> readPng(const std::filesystem::path& path);

} // namespace lightloom
