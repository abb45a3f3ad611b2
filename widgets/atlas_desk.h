// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/bake_view.h"
#include "widgets/gl/atlas_draw.h"
#include <QThreadPool>

namespace lightloom {

class Viewport;

/// Brings the scene's atlas into the viewport when its mode is first chosen: unwrapped on a thread of low priority,
/// once per scene; light comes into it on the GPU.
class AtlasDesk final : public QObject {
    Q_OBJECT
public:
    AtlasDesk(Viewport* viewport, QObject* parent);
    ~AtlasDesk() override; ///< stops what runs

    void forget();                      ///< another scene
    void setView(const BakeView& view); ///< its rays and lamps count
    void modeChanged();                 ///< the viewport's

Q_SIGNALS:
    void began();                 ///< the octree is shown until it is made
    void made(QString about);     ///< one line about the atlas
    void failed(QString problem); ///< the octree goes on being shown

private:
    void ask();

    Viewport* viewport_;
    QThreadPool pool_;
    std::stop_source stop_;
    std::shared_ptr<const RayScene> rays_;
    std::shared_ptr<const LightSampler> lights_;
    std::shared_ptr<const LightReach> reach_; ///< what the atlas has room for: the same wherever in a room lamps are
    bool isAsked_ = false;
    std::uint64_t serial_ = 0;
};

} // namespace lightloom
