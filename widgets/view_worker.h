// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/bake_view.h"
#include "widgets/picked_leaf.h"
#include "widgets/voxel_line_marks.h"
#include <QObject>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace lightloom {

/// One thread beside the bake for what the viewport asks for: the same light looked at in another way, the illuminance
/// under the cursor, a leaf that was picked, lines through voxels. Of each kind the newest request wins; looks come
/// first. Shoots no photons.
class ViewWorker final : public QObject {
    Q_OBJECT
public:
    explicit ViewWorker(QObject* parent = nullptr);
    ~ViewWorker() override;

    void look(BakeView view, Look look);
    /// Illuminance at `p` facing `n` from the view's field, and from its lamps with shadow rays under `mix`.
    void measure(BakeView view, Mix mix, glm::vec3 p, glm::vec3 n);

    /// What the view's octree or voxels keep at `p` facing `n`.
    void pick(BakeView view, glm::vec3 p, glm::vec3 n);

    /// Lines of direction number `direction` through the view's voxels.
    void lines(BakeView view, int direction);

Q_SIGNALS:
    void lined(lightloom::VoxelLineMarks lines);
    void looked(lightloom::BakeView view);
    void measured(lightloom::Measurement measurement);
    void picked(lightloom::PickedLeaf leaf);

private:
    struct LookRequest {
        BakeView view;
        Look look;
    };
    struct MeasureRequest {
        BakeView view;
        Mix mix;
        glm::vec3 p, n;
    };
    struct PickRequest {
        BakeView view;
        glm::vec3 p, n;
    };
    struct LineRequest {
        BakeView view;
        int direction = -1;
    };
    void work(const std::stop_token& quit);

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::optional<LookRequest> look_;
    std::optional<MeasureRequest> measure_;
    std::optional<PickRequest> pick_;
    std::optional<LineRequest> lines_;
    std::jthread thread_; // last: it uses all of the above
};

} // namespace lightloom
