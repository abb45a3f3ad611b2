// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/pick_desk.h"
#include "core/base/units.h"
#include "widgets/pick_card.h"
#include "widgets/pick_text.h"
#include "widgets/view_worker.h"
#include "widgets/viewport.h"
#include <QAction>

namespace lightloom {

namespace {

const glm::vec4 kBox(1.0f, 1.0f, 1.0f, 1.0f), kNormal(0.55f, 0.85f, 0.4f, 1.0f), kDot(0.35f, 0.75f, 1.0f, 1.0f),
    kArrow(1.0f, 0.75f, 0.2f, 1.0f), kOther(1.0f, 0.75f, 0.2f, 0.45f);

void addBox(const LeafPick& leaf, std::vector<Mark>& marks)
{
    const auto corner = [&](int i) {
        return glm::vec3(i & 1 ? leaf.high.x : leaf.low.x, i & 2 ? leaf.high.y : leaf.low.y,
                         i & 4 ? leaf.high.z : leaf.low.z);
    };
    for (int i = 0; i < 8; ++i) {
        for (const int axis : {1, 2, 4}) {
            if ((i & axis) == 0) marks.push_back({corner(i), corner(i | axis), kBox, 1.6f});
        }
    }
}

void addArrow(glm::vec3 tail, glm::vec3 head, glm::vec4 colour, float width, std::vector<Mark>& marks)
{
    marks.push_back({tail, head, colour, width});
    const glm::vec3 along = head - tail;
    const glm::vec3 aside = glm::abs(along.y) < 0.9f * glm::length(along) ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 u = glm::normalize(glm::cross(along, aside)), v = glm::normalize(glm::cross(along, u));
    const float size = 0.13f * glm::length(along);
    for (const glm::vec3 side : {u, -u, v, -v}) {
        marks.push_back({head, head - glm::normalize(along) * (1.6f * size) + side * (0.7f * size), colour, width});
    }
}

constexpr float kShareOfView = 0.12f; ///< of the way to the eye, so that arrows are seen apart

/// Length of the longest arrow: as far as the photons reach that the lights were made from, or what is well seen.
float reachOf(const PickedLeaf& picked, glm::vec3 eye)
{
    const LeafPick& leaf = *picked.leaf;
    float reach = glm::max(2.0f * (leaf.high.x - leaf.low.x), kShareOfView * glm::length(eye - leaf.point));
    if (leaf.answers < 0) return reach;
    const glm::vec3 centre = leaf.entries[static_cast<std::size_t>(leaf.answers)].surface.centroid;
    for (const glm::vec3 p : picked.photons) reach = glm::max(reach, 1.3f * glm::length(p - centre));
    return reach;
}

/// Where a light's arrow ends: it points to where the light comes from, the longer the more lux it gives.
glm::vec3 tipOf(const PickedEntry& entry, const Vdl& vdl, float most, float reach)
{
    const float share = most > 0.0f ? std::sqrt(luminance(vdl.colour) / most) : 0.0f;
    return entry.surface.centroid + vdl.toLight * (reach * (0.35f + 0.65f * share));
}

float mostOf(const LeafPick& leaf)
{
    float most = 0.0f;
    for (const PickedEntry& entry : leaf.entries) {
        for (const Vdl& vdl : entry.lights) most = glm::max(most, luminance(vdl.colour));
    }
    return most;
}

/// The vertices that light a place, each with a line to it.
std::vector<Mark> marksOf(const PickedGrid& grid)
{
    std::vector<Mark> marks{{grid.point, grid.point, kDot, 6.0f}};
    for (const glm::vec3 vertex : grid.vertices) {
        marks.push_back({grid.point, vertex, kOther, 1.6f});
        marks.push_back({vertex, vertex, kArrow, 7.0f});
    }
    return marks;
}

std::vector<Mark> marksOf(const PickedLeaf& picked, float reach)
{
    if (picked.grid) return marksOf(*picked.grid);
    std::vector<Mark> marks;
    if (!picked.leaf) return marks;
    const LeafPick& leaf = *picked.leaf;
    for (const glm::vec3 p : picked.photons) marks.push_back({p, p, kDot, 3.0f});
    addBox(leaf, marks);
    const float most = mostOf(leaf);
    for (std::size_t e = 0; e < leaf.entries.size(); ++e) {
        const PickedEntry& entry = leaf.entries[e];
        const bool isAnswer = static_cast<int>(e) == leaf.answers;
        addArrow(entry.surface.centroid, entry.surface.centroid + entry.surface.normal * (0.4f * reach), kNormal, 1.6f,
                 marks);
        for (const Vdl& vdl : entry.lights) {
            addArrow(entry.surface.centroid, tipOf(entry, vdl, most, reach), isAnswer ? kArrow : kOther, 2.4f, marks);
        }
    }
    return marks;
}

} // namespace

PickDesk::PickDesk(Viewport* viewport, ViewWorker* worker, QAction* tool, QObject* parent)
    : QObject(parent), viewport_(viewport), worker_(worker), tool_(tool), card_(new PickCard(viewport))
{
    connect(viewport_, &Viewport::picked, this, &PickDesk::pick);
    connect(viewport_, &Viewport::frameDrawn, this, &PickDesk::placeLabels);
    connect(worker_, &ViewWorker::picked, this, &PickDesk::take, Qt::QueuedConnection);
    connect(tool_, &QAction::toggled, this, [this](bool on) {
        viewport_->setPicking(on);
        if (!on) clear();
    });
}

void PickDesk::forget()
{
    view_ = {};
    clear();
}

void PickDesk::clear()
{
    place_.reset();
    picked_.reset();
    viewport_->setMarks({});
    card_->setLines({});
    Q_EMIT shown();
}

void PickDesk::setView(const BakeView& view)
{
    view_ = view;
    if (place_) worker_->pick(view_, place_->position, place_->normal);
}

void PickDesk::pick(glm::vec3 p, glm::vec3 n)
{
    if (!view_.snapshot.field) return;
    place_ = Place{p, n};
    tool_->setChecked(true); // so that it can be put away
    worker_->pick(view_, p, n);
}

void PickDesk::take(const PickedLeaf& leaf)
{
    if (!place_ || leaf.field != view_.snapshot.field) return; // of what was shown before
    picked_ = leaf;
    if (leaf.leaf) reach_ = reachOf(leaf, viewport_->camera().eye());
    viewport_->setMarks(marksOf(leaf, reach_));
    card_->setLines(pickText(leaf));
    placeLabels();
    Q_EMIT shown();
}

void PickDesk::placeLabels()
{
    if (!picked_ || !picked_->leaf) return card_->setLabels({});
    const LeafPick& leaf = *picked_->leaf;
    std::vector<PickCard::Label> labels;
    for (std::size_t e = 0; e < leaf.entries.size(); ++e) {
        if (static_cast<int>(e) != leaf.answers) continue;
        for (const Vdl& vdl : leaf.entries[e].lights) {
            const auto at = viewport_->placeIn(tipOf(leaf.entries[e], vdl, mostOf(leaf), reach_));
            if (at) labels.push_back({*at + QPointF(6, 0), tr("%1 lx").arg(luxOfText(leaf.entries[e], vdl))});
        }
    }
    card_->setLabels(std::move(labels));
}

} // namespace lightloom
