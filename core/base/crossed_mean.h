// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/statistics.h"
#include <array>

namespace lightloom {

/// Means of K numbers over batches whose count is decided while they come in, free of the bias of stopping on one's own
/// noise: a stream that stops once its spread looks small stops early just when it has missed a rare bright value, and
/// then tells too little. Here batches go in turn to two chains, and each chain is ended by what the other has seen. A
/// chain's length is then independent of its own values, so its mean is unbiased, and so is the mean of both, for any
/// integrand (docs/decisions/005). Plain data: may be kept in a file and gone on with.
template<std::size_t K>
class CrossedMean {
public:
    using Values = std::array<double, K>;
    static constexpr std::uint64_t kLeast = 8; ///< batches of a chain before its spread is believed

    /// Takes the next batch.
    void add(const Values& values)
    {
        Chain& chain = chains_[isEven() ? 0 : 1];
        for (std::size_t k = 0; k < K; ++k) chain.seen[k].add(values[k]);
    }
    [[nodiscard]] std::uint64_t batches() const { return chains_[0].count() + chains_[1].count(); }

    /// After a whole pair of batches, at a few lengths only (each look is another chance to stop too soon): ends a
    /// chain if `isEnough(errors)` holds for the standard errors that the other chain foretells for both together.
    template<class IsEnough>
    void look(IsEnough isEnough)
    {
        if (!isLookDue()) return;
        for (int chain = 0; chain < 2; ++chain) {
            if (!isEnded(chain) && isEnough(foretold(1 - chain))) end(chain);
        }
    }
    /// The same by hand, for decisions that several means take together.
    [[nodiscard]] bool isLookDue() const { return isEven() && isLook(chains_[0].count()); }
    [[nodiscard]] Values foretold(int chain) const
    {
        Values errors;
        for (std::size_t k = 0; k < K; ++k) errors[k] = at(chain).seen[k].standardError() * kHalfRoot;
        return errors;
    }
    void end(int chain)
    {
        Chain& c = chains_[static_cast<std::size_t>(chain)];
        c.used = c.seen;
        c.isEnded = 1;
    }
    [[nodiscard]] bool isEnded(int chain) const { return at(chain).isEnded != 0; }
    [[nodiscard]] bool isEnded() const { return isEnded(0) && isEnded(1); }

    [[nodiscard]] double mean(std::size_t k) const
    {
        if (isAlike()) return joined(k).mean();
        return 0.5 * (used(0, k).mean() + used(1, k).mean());
    }
    /// Of the mean, from the spread of the batches in it; 0 for fewer than two. Up to a tenth too small where single
    /// batches are nearly always dark: chains that both end early have both seen little.
    [[nodiscard]] double standardError(std::size_t k) const
    {
        if (isAlike()) return joined(k).standardError();
        return 0.5 * std::hypot(used(0, k).standardError(), used(1, k).standardError());
    }

private:
    static constexpr double kHalfRoot = 0.70710678118654752;
    struct Chain {
        std::array<RunningMean, K> seen, used; // `used` stands still once the chain has ended
        std::uint64_t isEnded = 0;             // a whole word: no padding, files of it are the same bytes
        [[nodiscard]] std::uint64_t count() const { return seen[0].count(); }
    };
    [[nodiscard]] const Chain& at(int chain) const { return chains_[static_cast<std::size_t>(chain)]; }
    [[nodiscard]] bool isEven() const { return chains_[0].count() == chains_[1].count(); }
    /// 8, 10, 12, 15, 18, 22, ...
    static bool isLook(std::uint64_t count)
    {
        std::uint64_t at = kLeast;
        while (at < count) at += at / 4;
        return at == count;
    }
    [[nodiscard]] const RunningMean& used(int chain, std::size_t k) const
    {
        return isEnded(chain) ? at(chain).used[k] : at(chain).seen[k];
    }
    /// Every batch counts alike: so long as nothing has ended, or both chains are as long.
    [[nodiscard]] bool isAlike() const
    {
        return (!isEnded(0) && !isEnded(1)) || used(0, 0).count() == used(1, 0).count();
    }
    [[nodiscard]] RunningMean joined(std::size_t k) const
    {
        RunningMean all = used(0, k);
        all.merge(used(1, k));
        return all;
    }
    std::array<Chain, 2> chains_;
};

} // namespace lightloom
