// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace lightloom {

/// How sharp the next picture may be, and when one may come that nothing new asks for. While something moves pictures
/// keep to a frame's time and resolution gives way. While a bake wants the processor (it does where OpenGL is drawn by
/// the processor too) pictures that only polish take a small share of the time. Plain numbers, no clock, no widget.
class FramePacer {
public:
    static constexpr double kSmoothMs = 50.0; ///< a moving picture should not take longer
    static constexpr float kCoarsest = 0.25f;
    static constexpr int kQuickTellMs = 100, kSlowTellMs = 500;
    static constexpr double kPauses = 5.0; ///< polishing while a bake runs: this many times its own time is left alone

    /// The cost of pictures is not known any more: another scene.
    void forget() { fullMs_ = -1.0; }
    void setBusy(bool busy) { isBusy_ = busy; }
    [[nodiscard]] bool isBusy() const { return isBusy_; }

    /// A picture at `scale` times the resolution took `pictureMs`; its last part (all of it, where it was drawn at
    /// once), with all that came with it (uploads, shadow maps), `allMs`. Coarse ones adapt the coarse scale.
    void drew(float scale, bool isCoarse, double pictureMs, double allMs);

    /// Scale of pictures while something moves: 0.25 to 1.
    [[nodiscard]] float coarseScale() const { return coarseScale_; }
    /// While a bake runs: news from it is better shown coarse first, because a full picture is dear or not yet known.
    [[nodiscard]] bool showsNewsCoarse() const { return isBusy_ && isDear(); }
    /// A full picture takes longer than a smooth one may, or it is not known.
    [[nodiscard]] bool isDear() const { return !(fullMs_ >= 0.0 && fullMs_ <= kSmoothMs); }
    /// Before a picture that only polishes: sharper, smoother. At least 1, so that events get their turn.
    [[nodiscard]] int pauseMs() const { return pauseAfter(lastMs_); }
    /// The same after a part of one that took `ms`.
    [[nodiscard]] int pauseAfter(double ms) const;
    /// Between changes of the texts around the picture while a bake runs: each composes the whole window anew.
    [[nodiscard]] int tellMs() const { return showsNewsCoarse() ? kSlowTellMs : kQuickTellMs; }
    /// Before the sharp picture that follows a coarse one of news.
    [[nodiscard]] int sharpenMs() const;

private:
    bool isBusy_ = false;
    float coarseScale_ = 0.5f;
    double fullMs_ = -1.0; ///< estimate for full resolution; negative: unknown
    double lastMs_ = 0.0;
};

} // namespace lightloom
