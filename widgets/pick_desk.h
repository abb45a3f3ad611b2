// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/bake_view.h"
#include "widgets/picked_leaf.h"
#include <QObject>
#include <optional>

class QAction;

namespace lightloom {

class PickCard;
class ViewWorker;
class Viewport;

/// Shows what octree or voxels keep at a point that was picked: the cell as a wire box, its lights (of voxels, where a
/// lightcut's light comes from) as arrows with their lux, the photons gathered for it as dots, and all of it as text.
/// Follows the snapshot and the mix that are shown.
class PickDesk final : public QObject {
    Q_OBJECT
public:
    /// `tool`, checkable: the next click picks. Off: nothing is picked any more.
    PickDesk(Viewport* viewport, ViewWorker* worker, QAction* tool, QObject* parent);

    void forget();                      ///< another scene
    void setView(const BakeView& view); ///< under the mix that is shown

    [[nodiscard]] const std::optional<PickedLeaf>& picked() const { return picked_; }
    [[nodiscard]] PickCard& card() const { return *card_; }

Q_SIGNALS:
    void shown(); ///< a picked leaf, or that there is none

private:
    void pick(glm::vec3 p, glm::vec3 n);
    void clear();
    void take(const PickedLeaf& leaf);
    void placeLabels(); ///< at the tips of the arrows, as the camera sees them now

    Viewport* viewport_;
    ViewWorker* worker_;
    QAction* tool_;
    PickCard* card_; ///< child of the viewport
    BakeView view_;
    struct Place {
        glm::vec3 position, normal;
    };
    std::optional<Place> place_;
    std::optional<PickedLeaf> picked_;
    float reach_ = 1.0f; ///< of the longest arrow, metres
};

} // namespace lightloom
