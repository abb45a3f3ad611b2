// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/legend.h"
#include "widgets/bake_view.h"
#include "widgets/picture_worker.h"
#include <QTimer>

namespace lightloom {

class Viewport;

/// Brings pictures that the processor makes into the viewport while their mode is chosen: of the photon map, of voxels
/// by lightcuts. Asks for one of what the camera sees, and anew when camera, size, lamps or the bake are others. A bake
/// comes first.
class PictureDesk final : public QObject {
    Q_OBJECT
public:
    PictureDesk(Viewport* viewport, QObject* parent);

    void forget();                       ///< another scene
    void setView(const BakeView& view);  ///< under the mix that is shown
    void setShow(const VoxelShow& show); ///< of voxels
    void setBaking(bool isBaking);       ///< and not paused
    void modeChanged();                  ///< the viewport's
    void coverChanged();                 ///< errors lie over all of the picture, or no longer: it waits meanwhile

    /// What the picture shows: a photon map with its cache, or cuts; null: nothing yet.
    [[nodiscard]] const std::shared_ptr<const IndirectField>& field() const { return field_; }
    [[nodiscard]] QString stateText() const;
    /// Nothing more comes: no picture is wanted, there will be none, or it is whole.
    [[nodiscard]] bool isDone() const;
    void showCuts(bool on); ///< in place of light: how many clusters each pixel's lightcut took
    /// Lightcuts are what is looked at.
    [[nodiscard]] bool hasCuts() const { return isOfVoxels() && show_.lookup == VoxelLookup::lightcuts; }
    [[nodiscard]] std::optional<HeatmapStyle> cutScale() const; ///< of what is shown so; nothing: light is

Q_SIGNALS:
    void stateChanged();
    void fieldChanged(); ///< there is one now

private:
    void viewChanged();
    void hold();
    void ask();
    void take(const MadePicture& picture);
    [[nodiscard]] bool isWanted() const;
    [[nodiscard]] bool isOfVoxels() const; ///< the viewport's mode
    [[nodiscard]] std::shared_ptr<const VoxelField> voxels() const;
    [[nodiscard]] QString photonText() const;
    [[nodiscard]] QString voxelText() const;
    [[nodiscard]] QString cutText() const;
    [[nodiscard]] QString blockText() const;

    Viewport* viewport_;
    PictureWorker worker_;
    QTimer delay_;
    BakeView view_;
    MadePicture picture_;
    double part_ = 0.0; ///< of the work until each pixel has its own light
    VoxelShow show_;
    std::shared_ptr<const IndirectField> field_;
    bool isAskedOfVoxels_ = false;
    std::uint64_t serial_ = 0; ///< of the question that fits what is seen; 0: none was asked
    bool isBaking_ = false, cutsShown_ = false;
};

} // namespace lightloom
