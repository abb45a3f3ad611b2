// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/lamp_desk.h"
#include "widgets/viewport.h"
#include <QAction>
#include <QKeyEvent>
#include <QMouseEvent>
#include <limits>

namespace lightloom {

namespace {

constexpr float kSizeShare = 0.13f; ///< of handles, of the way to the eye
constexpr double kHandlePixels = 9.0, kLampPixels = 16.0, kOutlinePixels = 7.0, kClickPixels = 4.0;
const glm::vec4 kPlain(1.0f, 0.85f, 0.45f, 0.75f), kChosen(1.0f, 0.93f, 0.70f, 1.0f);

} // namespace

LampDesk::LampDesk(Viewport* viewport, QAction* tool, QObject* parent)
    : QObject(parent), viewport_(viewport), tool_(tool)
{
    viewport_->installEventFilter(this);
    connect(viewport_, &Viewport::viewMoved, this, &LampDesk::draw);
    connect(tool_, &QAction::toggled, this, [this](bool on) {
        if (!on) cancel();
        draw();
    });
}

void LampDesk::setScene(std::shared_ptr<const Scene> scene)
{
    held_ = near_ = LampHandle::none;
    before_.reset();
    scene_ = std::move(scene);
    outlines_ = scene_ ? outlinesOf(*scene_) : std::vector<std::vector<HandleLine>>();
    take(-1, -1);
}

void LampDesk::setLamps(std::shared_ptr<const Scene> scene)
{
    scene_ = std::move(scene);
    if (!isDragging()) near_ = cursor_ && tool_->isChecked() ? handleAt(*cursor_) : LampHandle::none;
    draw();
}

void LampDesk::choose(int group)
{
    int light = -1;
    for (int i = static_cast<int>(scene_->lights.size()) - 1; i >= 0; --i) {
        if (scene_->lights[static_cast<std::size_t>(i)].group == group) light = i;
    }
    take(group, light);
}

void LampDesk::take(int group, int light)
{
    group_ = group;
    light_ = light;
    draw();
    Q_EMIT chosen(group_, light_);
}

glm::vec3 LampDesk::anchor() const { return scene_->bounds.centre(); }

float LampDesk::sizeAt(glm::vec3 place) const { return kSizeShare * glm::length(place - viewport_->camera().eye()); }

std::vector<HandleLine> LampDesk::handles() const
{
    if (light_ < 0) return {};
    return handlesOf(lamp(), anchor(), sizeAt(lampPlace(lamp(), anchor())));
}

void LampDesk::draw()
{
    std::vector<Mark> marks;
    if (scene_ && tool_->isChecked()) {
        for (int i = 0; i < static_cast<int>(scene_->lights.size()); ++i) {
            const PunctualLight& one = scene_->lights[static_cast<std::size_t>(i)];
            const float size = sizeAt(lampPlace(one, anchor()));
            const std::vector<Mark> marker = markerOf(one, anchor(), size, i == light_ ? kChosen : kPlain);
            marks.insert(marks.end(), marker.begin(), marker.end());
        }
        for (std::size_t g = 0; g < outlines_.size(); ++g) {
            const bool isChosen = static_cast<int>(g) == group_;
            for (const HandleLine& line : outlines_[g]) {
                marks.push_back({line.a, line.b, isChosen ? kChosen : kPlain, isChosen ? 3.0f : 1.8f});
            }
        }
        const std::vector<Mark> grips = marksOf(handles(), held_ != LampHandle::none ? held_ : near_);
        marks.insert(marks.end(), grips.begin(), grips.end());
    }
    viewport_->setLampMarks(std::move(marks));
}

double LampDesk::pixelsTo(QPointF position, const HandleLine& line) const
{
    const auto a = viewport_->placeIn(line.a), b = viewport_->placeIn(line.b);
    if (!a || !b) return std::numeric_limits<double>::infinity();
    const QPointF d = *b - *a, p = position - *a;
    const double length2 = QPointF::dotProduct(d, d);
    const double t = length2 > 0.0 ? std::clamp(QPointF::dotProduct(p, d) / length2, 0.0, 1.0) : 0.0;
    const QPointF off = p - t * d;
    return std::sqrt(QPointF::dotProduct(off, off));
}

LampHandle LampDesk::handleAt(QPointF position) const
{
    LampHandle best = LampHandle::none;
    double nearest = kHandlePixels;
    for (const HandleLine& line : handles()) {
        // the lamp's own square lies over where the arrows start
        const double pixels = pixelsTo(position, line) - (line.handle == LampHandle::free ? 3.0 : 0.0);
        if (pixels < nearest) nearest = pixels, best = line.handle;
    }
    return best;
}

std::optional<QPointF> LampDesk::placeOfHandle(LampHandle handle) const
{
    glm::vec3 sum(0.0f);
    int count = 0;
    for (const HandleLine& line : handles()) {
        if (line.handle != handle) continue;
        // an arrow is held by its shaft, the first of its lines, a box by its middle
        if (handle != LampHandle::free) return viewport_->placeIn(glm::mix(line.a, line.b, 0.7f));
        sum += 0.5f * (line.a + line.b);
        ++count;
    }
    if (count == 0) return std::nullopt;
    return viewport_->placeIn(sum / static_cast<float>(count));
}

std::optional<QPointF> LampDesk::placeOfLamp(int light) const
{
    return viewport_->placeIn(lampPlace(scene_->lights[static_cast<std::size_t>(light)], anchor()));
}

/// Whether a line to the right crosses the rim an odd number of times. Not where a part of it is behind the eye.
bool LampDesk::isWithin(QPointF position, const std::vector<HandleLine>& rim) const
{
    bool isOdd = false;
    for (const HandleLine& line : rim) {
        const auto a = viewport_->placeIn(line.a), b = viewport_->placeIn(line.b);
        if (!a || !b) return false;
        if ((a->y() > position.y()) == (b->y() > position.y())) continue;
        const double x = a->x() + (position.y() - a->y()) * (b->x() - a->x()) / (b->y() - a->y());
        isOdd = isOdd != (x > position.x());
    }
    return isOdd;
}

bool LampDesk::press(const QMouseEvent& event)
{
    pressed_ = event.position();
    if (isDragging()) return true; // no other button moves the eye meanwhile
    // while the right one is down, the eye walks
    if (event.buttons() != Qt::LeftButton || event.modifiers() != Qt::NoModifier) return false;
    held_ = handleAt(pressed_);
    if (held_ == LampHandle::none) return false; // the camera's, or a click
    before_ = lamp();
    from_ = viewport_->sightAt(pressed_);
    anchorThen_ = anchor();
    sizeThen_ = sizeAt(lampPlace(lamp(), anchor()));
    draw();
    return true;
}

bool LampDesk::move(const QMouseEvent& event)
{
    cursor_ = event.position();
    if (isDragging() && !event.buttons().testFlag(Qt::LeftButton)) drop(); // let go where nobody told us
    if (isDragging()) {
        Q_EMIT dragged(light_, lightloom::dragged(*before_, held_, anchorThen_, sizeThen_, from_,
                                                  viewport_->sightAt(event.position())));
        return true;
    }
    if (event.buttons() != Qt::NoButton) return false;
    const LampHandle now = handleAt(event.position());
    if (now != near_) {
        near_ = now;
        draw();
    }
    return false;
}

bool LampDesk::release(const QMouseEvent& event)
{
    if (event.button() != Qt::LeftButton) return isDragging();
    if (isDragging()) {
        drop();
        return true;
    }
    if (event.modifiers() != Qt::NoModifier || (event.position() - pressed_).manhattanLength() >= kClickPixels) {
        return false;
    }
    int group = -1, light = -1;
    double nearest = kLampPixels;
    for (int i = 0; i < static_cast<int>(scene_->lights.size()); ++i) {
        const glm::vec3 place = lampPlace(scene_->lights[static_cast<std::size_t>(i)], anchor());
        const double pixels = pixelsTo(event.position(), {LampHandle::none, place, place});
        if (pixels < nearest) nearest = pixels, light = i, group = scene_->lights[static_cast<std::size_t>(i)].group;
    }
    nearest = std::min(nearest, kOutlinePixels);
    for (std::size_t g = 0; g < outlines_.size(); ++g) {
        for (const HandleLine& line : outlines_[g]) {
            const double pixels = pixelsTo(event.position(), line);
            if (pixels < nearest) nearest = pixels, light = -1, group = static_cast<int>(g);
        }
    }
    for (std::size_t g = 0; g < outlines_.size() && group < 0; ++g) {
        if (isWithin(event.position(), outlines_[g])) group = static_cast<int>(g);
    }
    if (group >= 0) take(group, light);
    return false;
}

void LampDesk::drop()
{
    held_ = LampHandle::none;
    const PunctualLight before = *before_;
    before_.reset();
    draw();
    Q_EMIT dropped(light_, before);
}

void LampDesk::cancel()
{
    if (!isDragging()) return;
    held_ = LampHandle::none;
    const PunctualLight before = *before_;
    before_.reset();
    Q_EMIT dragged(light_, before);
    draw();
}

bool LampDesk::eventFilter(QObject* watched, QEvent* event)
{
    if (watched != viewport_ || !scene_ || !tool_->isChecked()) return false;
    switch (event->type()) {
    case QEvent::MouseButtonPress:
    case QEvent::MouseButtonDblClick: // the second press in quick succession
        return press(*static_cast<QMouseEvent*>(event));
    case QEvent::MouseMove:
        return move(*static_cast<QMouseEvent*>(event));
    case QEvent::MouseButtonRelease:
        return release(*static_cast<QMouseEvent*>(event));
    case QEvent::Wheel:
        return isDragging();
    case QEvent::ShortcutOverride:
    case QEvent::KeyPress:
        // whatever a key does otherwise, undo or cancel the bake or move the eye: not in the middle of a drag
        if (!isDragging()) return false;
        event->accept();
        if (event->type() == QEvent::KeyPress && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) cancel();
        return true;
    default:
        return false;
    }
}

} // namespace lightloom
