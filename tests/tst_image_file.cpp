// SPDX-License-Identifier: Apache-2.0
// Claim: pictures survive a round trip through EXR (every bit, every layer, every note) and PNG; a damaged or hostile
// file is refused with one line and little memory, never with a crash.
#include "core/base/atomic_file.h"
#include "core/base/image_file.h"
#include "core/base/rng.h"
#include <QTemporaryDir>
#include <QtTest>
#include <bit>
#include <cmath>
#include <limits>

using namespace lightloom;

class ImageFileTest : public QObject {
    Q_OBJECT
    QTemporaryDir folder_;

    std::filesystem::path at(const char* name) const { return folder_.filePath(name).toStdString(); }

    static FloatImage noise(int width, int height, std::uint64_t seed)
    {
        FloatImage image(width, height);
        Rng rng(seed, 0, 0);
        for (glm::vec3& p : image.pixels) {
            p = {rng.uniform() * 1e4f, rng.uniform() - 0.5f, std::ldexp(rng.uniform(), -100)};
        }
        return image;
    }

    static bool sameBits(const FloatImage& a, const FloatImage& b)
    {
        if (!a.isSameSize(b)) return false;
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
            for (int c = 0; c < 3; ++c) {
                const auto x = std::bit_cast<std::uint32_t>(a.pixels[i][c]);
                if (x != std::bit_cast<std::uint32_t>(b.pixels[i][c])) return false;
            }
        }
        return true;
    }

    static bool isOneLine(const std::string& text) { return !text.empty() && text.find('\n') == std::string::npos; }

    static void setBigEndian(std::vector<std::uint8_t>& bytes, std::size_t offset, std::uint32_t value)
    {
        for (std::size_t i = 0; i < 4; ++i) bytes[offset + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
    }

private Q_SLOTS:
    void exrKeepsEveryBit()
    {
        LayeredImage image;
        image.layers = {{"", noise(37, 21, 1)}, {"direct", noise(37, 21, 2)}, {"indirect", noise(37, 21, 3)}};
        image.layers[0].image.at(3, 4).x = std::numeric_limits<float>::infinity();
        image.layers[0].image.at(5, 6).y = std::numeric_limits<float>::quiet_NaN();
        image.notes = {{"lightloom.method", "light-octree"}, {"lightloom.parameter.photons", "400000"}};
        QVERIFY(static_cast<bool>(writeExr(at("round.exr"), image)));
        const Result<LayeredImage> read = readExr(at("round.exr"));
        QVERIFY2(static_cast<bool>(read), read ? "" : read.error().message.c_str());
        QCOMPARE(read->layers.size(), std::size_t{3});
        for (const ImageLayer& layer : image.layers) {
            const FloatImage* found = read->find(layer.name);
            QVERIFY2(found && sameBits(*found, layer.image), layer.name.c_str());
        }
        for (const auto& note : image.notes) QVERIFY(std::ranges::find(read->notes, note) != read->notes.end());
        QVERIFY(read->find("error") == nullptr);
    }

    void sameImageSameBytes()
    {
        const LayeredImage image{{{"", noise(16, 16, 1)}}, {{"lightloom.seed", "1"}}};
        QVERIFY(static_cast<bool>(writeExr(at("a.exr"), image)) && static_cast<bool>(writeExr(at("b.exr"), image)));
        QVERIFY(*readFile(at("a.exr"), 1 << 20) == *readFile(at("b.exr"), 1 << 20));
    }

    void pngKeepsEveryByteAndItsNotes()
    {
        ByteImage image{5, 3, {}};
        for (int i = 0; i < 45; ++i) image.rgb.push_back(static_cast<std::uint8_t>(i * 5));
        QVERIFY(static_cast<bool>(writePng(at("round.png"), image, {{"Software", "Lightloom"}})));
        const Result<ByteImage> read = readPng(at("round.png"));
        QVERIFY2(static_cast<bool>(read), read ? "" : read.error().message.c_str());
        QCOMPARE(read->width, 5);
        QVERIFY(read->rgb == image.rgb);
        // the note's chunk: length, type, text and the CRC-32 that zlib gives for it
        const std::vector<std::uint8_t> bytes = *readFile(at("round.png"), 1 << 20);
        const std::string chunk("\0\0\0\x12tEXtSoftware\0Lightloom\x95\xde\xcf\xfd", 30);
        QVERIFY(std::search(bytes.begin(), bytes.end(), chunk.begin(), chunk.end(), [](std::uint8_t a, char b) {
                    return a == static_cast<std::uint8_t>(b);
                }) == bytes.begin() + 33);
    }

    void srgbCurve()
    {
        QCOMPARE(decodeSrgb(0.0f), 0.0f);
        QVERIFY(std::abs(decodeSrgb(1.0f) - 1.0f) <= 1e-6f);
        QVERIFY(std::abs(decodeSrgb(0.5f) - 0.21404114f) <= 1e-6f); // IEC 61966-2-1
        for (int i = 0; i <= 255; ++i) {
            const float v = float(i) / 255.0f;
            QVERIFY(std::abs(encodeSrgb(decodeSrgb(v)) - v) <= 1e-5f);
        }
    }

    void srgbRoundTrip()
    {
        ByteImage ramp{256, 1, {}};
        for (int i = 0; i < 256; ++i) ramp.rgb.insert(ramp.rgb.end(), 3, static_cast<std::uint8_t>(i));
        QVERIFY(toBytes(toLinear(ramp)).rgb == ramp.rgb);
        FloatImage odd(3, 1);
        odd.pixels = {glm::vec3(std::numeric_limits<float>::quiet_NaN()), glm::vec3(-1.0f), glm::vec3(1e30f)};
        QVERIFY((toBytes(odd).rgb == std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 255, 255, 255}));
    }

    void everyCutAndFlipOfAnExrIsSurvived()
    {
        const LayeredImage image{{{"", noise(8, 8, 1)}, {"indirect", noise(8, 8, 2)}}, {{"lightloom.seed", "1"}}};
        QVERIFY(static_cast<bool>(writeExr(at("good.exr"), image)));
        const std::vector<std::uint8_t> good = *readFile(at("good.exr"), 1 << 20);
        int refused = 0;
        for (std::size_t length = 0; length < good.size(); length += 7) {
            QVERIFY(static_cast<bool>(writeFile(at("cut.exr"), std::span(good).first(length))));
            const Result<LayeredImage> read = readExr(at("cut.exr"));
            QVERIFY2(!read && isOneLine(read.error().message), qPrintable(QString("cut at %1").arg(length)));
        }
        for (std::size_t byte = 0; byte < good.size(); byte += 3) {
            std::vector<std::uint8_t> bad = good;
            bad[byte] ^= static_cast<std::uint8_t>(1u << (byte % 8));
            QVERIFY(static_cast<bool>(writeFile(at("flip.exr"), std::span(bad))));
            const Result<LayeredImage> read = readExr(at("flip.exr"));
            if (!read) QVERIFY2(isOneLine(read.error().message), read.error().message.c_str());
            refused += read ? 0 : 1;
        }
        QVERIFY2(refused > 20, qPrintable(QString("%1 flips were noticed").arg(refused)));
    }

    void hugeSizesInHeadersAreRefused()
    {
        const LayeredImage image{{{"", noise(8, 8, 1)}}, {}};
        QVERIFY(static_cast<bool>(writeExr(at("small.exr"), image)));
        std::vector<std::uint8_t> bytes = *readFile(at("small.exr"), 1 << 20);
        const std::string key = "dataWindow";
        const auto found = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
        QVERIFY(found != bytes.end());
        const auto maxX = static_cast<std::size_t>(found - bytes.begin()) + 11 + 6 + 4 + 8; // name, type, size, min
        bytes[maxX] = 0xFF, bytes[maxX + 1] = 0xFF, bytes[maxX + 2] = 0xFF, bytes[maxX + 3] = 0x7F;
        QVERIFY(static_cast<bool>(writeFile(at("huge.exr"), std::span(bytes))));
        const Result<LayeredImage> read = readExr(at("huge.exr"));
        QVERIFY(!read && isOneLine(read.error().message));

        QVERIFY(static_cast<bool>(writePng(at("small.png"), ByteImage{2, 2, std::vector<std::uint8_t>(12, 9)})));
        bytes = *readFile(at("small.png"), 1 << 20);
        setBigEndian(bytes, 16, 900'000);
        setBigEndian(bytes, 20, 900'000);
        QVERIFY(static_cast<bool>(writeFile(at("huge.png"), std::span(bytes))));
        const Result<ByteImage> png = readPng(at("huge.png"));
        QVERIFY(!png && isOneLine(png.error().message));
    }

    void everyCutOfAPngIsRefused()
    {
        ByteImage image{9, 9, {}};
        Rng rng(1, 2, 3);
        for (int i = 0; i < 243; ++i) image.rgb.push_back(static_cast<std::uint8_t>(rng.bits()));
        QVERIFY(static_cast<bool>(writePng(at("good.png"), image)));
        const std::vector<std::uint8_t> good = *readFile(at("good.png"), 1 << 20);
        for (std::size_t length = 0; length + 16 < good.size(); length += 5) { // IEND is not needed for the pixels
            QVERIFY(static_cast<bool>(writeFile(at("cut.png"), std::span(good).first(length))));
            const Result<ByteImage> read = readPng(at("cut.png"));
            QVERIFY2(!read && isOneLine(read.error().message), qPrintable(QString("cut at %1").arg(length)));
        }
    }

    void whatIsNoPictureIsNamed()
    {
        QVERIFY(static_cast<bool>(writeFile(at("text.exr"), std::string_view("not a picture"))));
        QVERIFY(!readExr(at("text.exr")) && !readPng(at("text.exr")));
        QVERIFY(readExr(at("text.exr")).error().message.find("text.exr") != std::string::npos);
        QCOMPARE(readExr(at("none.exr")).error().kind, Error::Kind::notFound);
        QCOMPARE(readPng(folder_.path().toStdString()).error().kind, Error::Kind::badInput);
    }
};

QTEST_APPLESS_MAIN(ImageFileTest)
#include "tst_image_file.moc"
