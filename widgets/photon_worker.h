// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/bake/progressive_view.h"
#include "core/photonmap/photon_map_solver.h"
#include <QMetaType>
#include <QObject>
#include <QString>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace lightloom {

/// What is to be seen of a photon map.
struct PhotonQuestion {
    std::shared_ptr<const PhotonMapField> photons; ///< under its mix, without caches
    std::shared_ptr<const RayScene> rays;
    std::shared_ptr<const LightSampler> lights;
    ViewJob job; ///< by the field, without a target
};

/// A picture of a photon map as far as it has come. Never changed afterwards, cheap to copy.
struct PhotonPicture {
    std::shared_ptr<const View> view;            ///< null: not yet, the cache is being filled
    std::shared_ptr<const PhotonMapField> field; ///< with its cache; null likewise
    double filled = 0.0;                         ///< part of the cache, 0 to 1
    std::uint64_t serial = 0;                    ///< of its question
    QString problem;                             ///< why there will be none; empty: there will
};

/// One thread of low priority that fills Christensen's cache from a bake's photons and renders what the camera sees of
/// it, a slice at a time. While held (a bake runs) it does nothing. A cache stays while its photons do: another camera
/// or another mix needs a new picture only.
class PhotonWorker final : public QObject {
    Q_OBJECT
public:
    explicit PhotonWorker(QObject* parent = nullptr);
    ~PhotonWorker() override; ///< stops what runs

    std::uint64_t ask(PhotonQuestion question); ///< the newest question wins; gives its serial
    void cancel();                              ///< forgets the question; what is cached stays
    void setHeld(bool held);

Q_SIGNALS:
    void shown(lightloom::PhotonPicture picture);

private:
    /// What the thread works on.
    struct Desk {
        std::optional<PhotonQuestion> question;
        std::uint64_t serial = 0;
        std::vector<PhotonMapField::Layer> cached; ///< of the photons that were asked for last
        std::shared_ptr<const PhotonMapField> field;
        std::optional<ProgressiveView> rough, fine;
    };
    void work(const std::stop_token& quit);
    void fill(Desk& desk, Workers& workers, const std::stop_token& quit);
    void draw(Desk& desk, Workers& workers, const std::stop_token& stop);

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::stop_source drawing_, filling_; ///< of the slice, and of the cache, that is being made
    std::optional<PhotonQuestion> question_;
    std::uint64_t serial_ = 0;
    std::vector<std::shared_ptr<const PhotonMap>> fillingFor_;
    bool isForgotten_ = false, isHeld_ = false;
    std::jthread thread_; // last: it uses all of the above
};

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::PhotonPicture)
