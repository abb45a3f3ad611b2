// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/lightcuts/light_tree.h"

namespace lightloom {

/// Lights of a tree drawn at random, each as often as its share of the area of all that are not dark. Draw i depends on
/// (seed, i) alone: more of them begin with the same.
class LightSamples {
public:
    LightSamples(const LightTree& tree, std::size_t count, std::uint64_t seed);
    [[nodiscard]] std::size_t count() const { return drawn_.size(); }            ///< 0 where all lights are dark
    [[nodiscard]] std::uint32_t drawn(std::size_t i) const { return drawn_[i]; } ///< number in the tree's order
    [[nodiscard]] double area() const { return area_; }                          ///< m2, of all lights but dark ones

private:
    double area_ = 0.0;
    std::vector<std::uint32_t> drawn_;
};

} // namespace lightloom
