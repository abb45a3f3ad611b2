// SPDX-License-Identifier: Apache-2.0
// JPEG through libjpeg-turbo, which reports errors by a callback that must not return: ours jumps. As with PNG, the
// functions that are jumped over hold nothing with a destructor.
#include "core/scene/image_decode.h"
#include <csetjmp>
#include <cstdio>
#include <fmt/format.h>
#include <jpeglib.h>

#include <jerror.h>

namespace lightloom::detail {
namespace {

/// A progressive file may repeat its scans without end, each costing a pass over all pixels.
constexpr int kMostScans = 64;

struct JpegErrors {
    jpeg_error_mgr base; ///< first, so that libjpeg's pointer to it is a pointer to this
    std::jmp_buf jump;
    char message[JMSG_LENGTH_MAX];
};

JpegErrors& errorsOf(j_common_ptr jpeg) { return *reinterpret_cast<JpegErrors*>(jpeg->err); }

[[noreturn]] void onError(j_common_ptr jpeg)
{
    JpegErrors& errors = errorsOf(jpeg);
    errors.base.format_message(jpeg, errors.message);
    std::longjmp(errors.jump, 1);
}

/// Missing data makes libjpeg go on with grey: wrong light without a word, so it counts as an error. Other oddities
/// (stray bytes between markers, say) leave the picture whole.
void onMessage(j_common_ptr jpeg, int level)
{
    const int code = jpeg->err->msg_code;
    if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE)) onError(jpeg);
}

void onProgress(j_common_ptr jpeg)
{
    if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number > kMostScans) {
        jpeg->err->msg_code = JERR_BAD_PROGRESSION;
        onError(jpeg);
    }
}

/// Owns the decoder's state.
class JpegReader {
public:
    JpegReader()
    {
        jpeg.err = jpeg_std_error(&errors.base);
        errors.base.error_exit = onError;
        errors.base.emit_message = onMessage;
        errors.message[0] = '\0';
    }
    ~JpegReader()
    {
        if (isCreated) jpeg_destroy_decompress(&jpeg);
    }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    [[nodiscard]] Error error() const
    {
        return {Error::Kind::badInput, fmt::format("the JPEG is damaged or of a kind not read ({})", errors.message)};
    }

    jpeg_decompress_struct jpeg{};
    JpegErrors errors{};
    jpeg_progress_mgr progress{};
    bool isCreated = false;
};

bool readHeader(JpegReader& reader, const std::uint8_t* bytes, unsigned long count)
{
    if (setjmp(reader.errors.jump) != 0) return false;
    jpeg_create_decompress(&reader.jpeg);
    reader.isCreated = true;
    reader.progress.progress_monitor = onProgress;
    reader.jpeg.progress = &reader.progress;
    reader.jpeg.mem->max_memory_to_use = 1L << 30;
    jpeg_mem_src(&reader.jpeg, bytes, count);
    jpeg_read_header(&reader.jpeg, TRUE);
    return true;
}

bool readPixels(JpegReader& reader, std::uint8_t* rgba)
{
    if (setjmp(reader.errors.jump) != 0) return false;
    reader.jpeg.out_color_space = JCS_EXT_RGBA; // CMYK cannot become this: libjpeg says so
    jpeg_start_decompress(&reader.jpeg);
    while (reader.jpeg.output_scanline < reader.jpeg.output_height) {
        JSAMPROW row = rgba + static_cast<std::size_t>(reader.jpeg.output_scanline) * reader.jpeg.output_width * 4;
        jpeg_read_scanlines(&reader.jpeg, &row, 1);
    }
    jpeg_finish_decompress(&reader.jpeg);
    return true;
}

} // namespace

Result<ImageSize> jpegSize(std::span<const std::uint8_t> file)
{
    JpegReader reader;
    if (!readHeader(reader, file.data(), file.size())) return reader.error();
    return ImageSize{static_cast<int>(reader.jpeg.image_width), static_cast<int>(reader.jpeg.image_height)};
}

Result<Image> decodeJpeg(std::span<const std::uint8_t> file, ImageSize size)
{
    // every 8 x 8 block takes at least a bit: a file shorter than that cannot hold the pixels its header promises
    if (size.pixels() > 512 * static_cast<std::uint64_t>(file.size())) {
        return Error{Error::Kind::badInput, fmt::format("the JPEG is damaged ({} bytes cannot hold {} x {} pixels)",
                                                        file.size(), size.width, size.height)};
    }
    JpegReader reader;
    if (!readHeader(reader, file.data(), file.size())) return reader.error();
    Image image;
    image.width = size.width;
    image.height = size.height;
    image.rgba.resize(size.pixels() * 4);
    if (!readPixels(reader, image.rgba.data())) return reader.error();
    return image;
}

} // namespace lightloom::detail
