// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/bake_view.h"
#include "widgets/photon_worker.h"
#include <QTimer>

namespace lightloom {

class Viewport;

/// Brings the photon map into the viewport while its mode is chosen: asks for a picture of what the camera sees, and
/// anew when camera, size, lamps or photons are others. A bake comes first.
class PhotonDesk final : public QObject {
    Q_OBJECT
public:
    PhotonDesk(Viewport* viewport, QObject* parent);

    void forget();                      ///< another scene
    void setView(const BakeView& view); ///< under the mix that is shown
    void setBaking(bool isBaking);      ///< and not paused
    void modeChanged();                 ///< the viewport's

    /// The photon map as it is shown, with its cache; null: not yet.
    [[nodiscard]] const std::shared_ptr<const PhotonMapField>& field() const { return field_; }
    [[nodiscard]] QString stateText() const;

Q_SIGNALS:
    void stateChanged();
    void fieldChanged(); ///< there is one now

private:
    void viewChanged();
    void ask();
    void take(const PhotonPicture& picture);
    [[nodiscard]] bool isWanted() const;

    Viewport* viewport_;
    PhotonWorker worker_;
    QTimer delay_;
    BakeView view_;
    PhotonPicture picture_;
    std::shared_ptr<const PhotonMapField> field_;
    std::uint64_t serial_ = 0; ///< of the question that fits what is seen; 0: none was asked
    bool isBaking_ = false;
};

} // namespace lightloom
