// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/bake/progressive_view.h"
#include "core/compare/cut_map.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/voxel/voxel_cuts.h"
#include <QMetaType>
#include <QObject>
#include <QString>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace lightloom {

/// What the processor is to make a picture of: a photon map or, where there are any, voxels as lights.
struct PictureQuestion {
    std::shared_ptr<const PhotonMapField> photons; ///< under its mix, without caches
    std::shared_ptr<const VoxelField> voxels;      ///< under its mix
    VoxelShow show;                                ///< of voxels
    std::shared_ptr<const RayScene> rays;
    std::shared_ptr<const LightSampler> lights;
    ViewJob job; ///< by the field, without a target
};

/// A picture as far as it has come. Never changed afterwards, cheap to copy.
struct MadePicture {
    std::shared_ptr<const View> view;           ///< null: not yet, what it is made from is being made
    std::shared_ptr<const IndirectField> field; ///< that it shows: a map with its cache, or cuts; null likewise
    double filled = 0.0;                        ///< part of a photon map's cache, 0 to 1
    std::shared_ptr<const CutMap> cuts;         ///< of a picture by lightcuts; else null
    int block = 1;                              ///< pixels of the window, each way, that share their light
    std::uint64_t serial = 0;                   ///< of its question
    QString problem;                            ///< why there will be none; empty: there will
};

/// One thread of low priority that renders what the camera sees, a slice at a time: of a photon map (it fills
/// Christensen's cache from a bake's photons first), or of lit voxels by lightcuts, in blocks of pixels that get
/// smaller. While held (a bake runs) it does nothing. A cache stays while its photons do: another camera or another mix
/// needs a new picture only.
class PictureWorker final : public QObject {
    Q_OBJECT
public:
    explicit PictureWorker(QObject* parent = nullptr);
    ~PictureWorker() override; ///< stops what runs

    std::uint64_t ask(PictureQuestion question); ///< the newest question wins; gives its serial
    void cancel();                               ///< forgets the question; what is cached stays
    void setHeld(bool held);

Q_SIGNALS:
    void shown(lightloom::MadePicture picture);
    /// While voxels are shown in blocks of pixels: how much of the work is done, 0 to 1, until each pixel has its own.
    void workedOn(std::uint64_t serial, double part);

private:
    /// What the thread works on.
    struct Desk {
        std::optional<PictureQuestion> question;
        std::uint64_t serial = 0;
        std::vector<PhotonMapField::Layer> cached; ///< of the photons that were asked for last
        std::shared_ptr<const IndirectField> field;
        std::shared_ptr<const VoxelField> voxels; ///< that the field was made of; null: of photons
        VoxelShow show;                           ///< likewise
        std::vector<ProgressiveView> pictures;    ///< still to be made, the finest first
        [[nodiscard]] bool isDone() const { return pictures.size() == 1 && pictures.front().isWhole(); }
    };
    void work(const std::stop_token& quit);
    void takeUp(PictureQuestion question, Desk& desk);
    void fill(Desk& desk, Workers& workers, const std::stop_token& quit);
    void draw(Desk& desk, Workers& workers, const std::stop_token& stop);

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::stop_source drawing_, filling_; ///< of the slice, and of the cache, that is being made
    std::optional<PictureQuestion> question_;
    std::uint64_t serial_ = 0;
    std::vector<std::shared_ptr<const PhotonMap>> fillingFor_;
    bool isForgotten_ = false, isHeld_ = false;
    std::jthread thread_; // last: it uses all of the above
};

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::MadePicture)
