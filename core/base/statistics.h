// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstdint>
#include <span>

namespace lightloom {

/// Mean and variance of a stream of numbers (Welford's update: no cancellation), mergeable in a fixed order.
class RunningMean {
public:
    void add(double x)
    {
        ++count_;
        const double d = x - mean_;
        mean_ += d / static_cast<double>(count_);
        m2_ += d * (x - mean_);
    }
    void merge(const RunningMean& other)
    {
        if (other.count_ == 0) return;
        const double n = static_cast<double>(count_), m = static_cast<double>(other.count_), d = other.mean_ - mean_;
        mean_ += d * m / (n + m);
        m2_ += other.m2_ + d * d * n * m / (n + m);
        count_ += other.count_;
    }
    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] double mean() const { return mean_; }
    /// Unbiased; 0 for fewer than two numbers.
    [[nodiscard]] double variance() const { return count_ > 1 ? m2_ / static_cast<double>(count_ - 1) : 0.0; }
    /// Standard error of the mean.
    [[nodiscard]] double standardError() const
    {
        return count_ > 1 ? std::sqrt(variance() / static_cast<double>(count_)) : 0.0;
    }

private:
    std::uint64_t count_ = 0;
    double mean_ = 0.0, m2_ = 0.0;
};

/// Spearman's rank correlation of two lists of the same length (asserted): 1 where one rises whenever the other does, 0
/// where they have nothing to do with each other. Equal values share the mean of their ranks. 0 if a list is constant.
[[nodiscard]] double rankCorrelation(std::span<const double> a, std::span<const double> b);

} // namespace lightloom
