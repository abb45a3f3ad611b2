// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/photon_sums.h"
#include "core/base/sampling.h"
#include "core/base/wide_vectors.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

using Doubles4 = double __attribute__((vector_size(32)));
using Longs4 = std::int64_t __attribute__((vector_size(32)));

} // namespace

PhotonSums::PhotonSums(const PhotonMap& map, glm::vec3 p, glm::vec3 n)
{
    const Frame frame(n);
    place_.photons = map.paths().photons.data();
    for (int i = 0; i < 3; ++i)
        place_.p[i] = p[i], place_.tangent[i] = frame.tangent[i], place_.bitangent[i] = frame.bitangent[i];
}

LIGHTLOOM_WIDE_VECTORS void PhotonSums::add(const Place& place, const std::uint32_t* numbers, std::size_t count,
                                            double* sums)
{
    static_assert(offsetof(Photon, normal) == offsetof(Photon, flux) + sizeof(glm::vec3)); // four numbers from flux on
    Doubles4 s[rows];
    for (std::size_t r = 0; r < rows; ++r) s[r] = lanesOf<Doubles4>(sums, r);
    for (std::size_t i = 0; i < count; ++i) {
        const Photon& photon = place.photons[numbers[i]];
        const float dx = photon.position.x - place.p[0], dy = photon.position.y - place.p[1],
                    dz = photon.position.z - place.p[2];
        const double x = static_cast<double>(dx * place.tangent[0] + dy * place.tangent[1] + dz * place.tangent[2]);
        const double y =
            static_cast<double>(dx * place.bitangent[0] + dy * place.bitangent[1] + dz * place.bitangent[2]);
        const double luminous = static_cast<double>(luminance(photon.flux));
        const Doubles4 colour = __builtin_convertvector(lanesOf<Floats4>(&photon.flux.x, 0), Doubles4);
        const Doubles4 where{1.0, x, y, 0.0};
        const Doubles4 square = luminous * luminous * where;
        s[flux] += colour;
        s[fluxX] += x * colour;
        s[fluxY] += y * colour;
        s[squares] += square;
        s[squaresSecond] +=
            __builtin_shuffle(square, Longs4{1, 1, 2, 3}) * __builtin_shuffle(where, Longs4{1, 2, 2, 3});
    }
    for (std::size_t r = 0; r < rows; ++r) lanesOf<Doubles4>(sums, r) = s[r];
}

glm::dvec3 PhotonSums::lux(glm::dvec3 w) const { return w.x * row(flux) + w.y * row(fluxX) + w.z * row(fluxY); }

double PhotonSums::value(glm::dvec3 w) const { return static_cast<double>(luminance(glm::vec3(lux(w)))); }

double PhotonSums::noise(glm::dvec3 w) const
{
    const glm::dvec3 s = row(squares), second = row(squaresSecond);
    const double variance = w.x * w.x * s.x + 2.0 * w.x * (w.y * s.y + w.z * s.z) + w.y * w.y * second.x +
                            2.0 * w.y * w.z * second.y + w.z * w.z * second.z;
    return std::sqrt(std::max(0.0, variance));
}

} // namespace lightloom
