// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/lamp_editor.h"
#include "core/base/units.h"
#include <QColorDialog>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>
#include <cmath>

namespace lightloom {

namespace {

constexpr double kFarthest = 1e7, kBrightest = 1e9; ///< metres; candela or lux
constexpr float kWidestInner = 0.999f;              ///< of the outer cone, as the reader has it
constexpr float kRightAngle = 1.5707963f;           ///< the widest cone that a file may have

/// Degrees around +Y from +Z towards +X, and up from the horizon.
glm::dvec2 anglesOf(glm::vec3 travel)
{
    const glm::dvec3 d(travel);
    return {glm::degrees(std::atan2(d.x, d.z)), glm::degrees(std::asin(glm::clamp(d.y, -1.0, 1.0)))};
}

glm::vec3 travelOf(double turnDeg, double tiltDeg)
{
    const double turn = glm::radians(turnDeg), tilt = glm::radians(tiltDeg);
    return glm::vec3(std::sin(turn) * std::cos(tilt), std::sin(tilt), std::cos(turn) * std::cos(tilt));
}

float toShown(float linear)
{
    const float c = glm::clamp(linear, 0.0f, 1.0f);
    return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
}
float toLinear(float shown) { return shown <= 0.04045f ? shown / 12.92f : std::pow((shown + 0.055f) / 1.055f, 2.4f); }

/// The brightest screen colour of this tint.
QColor shownColour(glm::vec3 tint)
{
    const glm::vec3 c = tint / glm::max(maxChannel(tint), 1e-30f);
    return QColor::fromRgbF(toShown(c.x), toShown(c.y), toShown(c.z));
}

} // namespace

LampEditor::LampEditor(QWidget* parent)
    : QWidget(parent), title_(new QLabel), form_(new QWidget), rows_(new QFormLayout(form_)), colour_(new QPushButton)
{
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 4, 0, 0);
    column->addWidget(title_);
    column->addWidget(form_);
    title_->setWordWrap(true);
    rows_->setContentsMargins(0, 0, 6, 0);
    rows_->setVerticalSpacing(2);
    const QString place = tr("Where the lamp hangs, in the file's frame; +Y is up.");
    x_ = addField("lampX", tr("x"), -kFarthest, kFarthest, 3, tr(" m"), place);
    y_ = addField("lampY", tr("y"), -kFarthest, kFarthest, 3, tr(" m"), place);
    z_ = addField("lampZ", tr("z"), -kFarthest, kFarthest, 3, tr(" m"), place);
    turn_ = addField("lampTurn", tr("Turn"), -180.0, 180.0, 1, tr("°"),
                     tr("Where its light goes: around the vertical, 0 is +Z, 90 is +X."));
    tilt_ = addField("lampTilt", tr("Tilt"), -90.0, 90.0, 1, tr("°"),
                     tr("Where its light goes: above the horizon; -90 is straight down."));
    turn_->setWrapping(true);
    intensity_ = addField("lampIntensity", tr("Intensity"), 0.0, kBrightest, 1, {},
                          tr("Luminous intensity, or a sun's illuminance. Retraces this lamp; the dimmer does not."));
    inner_ =
        addField("lampInner", tr("Full within"), 0.0, 90.0, 1, tr("°"), tr("Half angle of the cone of full light."));
    outer_ =
        addField("lampOuter", tr("Dark beyond"), 0.1, 90.0, 1, tr("°"), tr("Half angle of the cone of any light."));
    colour_->setObjectName(QStringLiteral("lampColour"));
    colour_->setAccessibleName(tr("Colour of the lamp"));
    colour_->setToolTip(tr("Colour of the light; its intensity stays."));
    rows_->addRow(tr("Colour"), colour_);
    connect(colour_, &QPushButton::clicked, this, &LampEditor::chooseColour);
    setLamp(nullptr, -1, -1);
}

QDoubleSpinBox* LampEditor::addField(const QString& name, const QString& label, double least, double most, int decimals,
                                     const QString& unit, const QString& tip)
{
    auto* field = new QDoubleSpinBox;
    field->setObjectName(name);
    field->setRange(least, most);
    field->setDecimals(decimals);
    field->setSingleStep(decimals == 3 ? 0.05 : 1.0);
    field->setSuffix(unit);
    field->setAccessibleName(label);
    field->setToolTip(tip);
    field->setMinimumWidth(60);
    field->setKeyboardTracking(false); // half a number is no place for a lamp
    rows_->addRow(label, field);
    connect(field, &QDoubleSpinBox::valueChanged, this, [this, label] {
        if (!filling_) tell(label);
    });
    return field;
}

void LampEditor::setLamp(const std::shared_ptr<const Scene>& scene, int group, int light)
{
    if (!scene || !scene_ || !scene->meshes.isSharedWith(scene_->meshes)) tints_.clear(); // another scene
    scene_ = scene;
    light_ = scene ? light : -1;
    form_->setVisible(light_ >= 0);
    if (!scene || group < 0) return;
    const LightGroup& named = scene->groups[static_cast<std::size_t>(group)];
    const QString name = QString::fromStdString(named.label.empty() ? named.id : named.label).toHtmlEscaped();
    if (light_ < 0) {
        title_->setText(tr("<b>%1</b> is a glowing surface: its place is part of the scene. Dim it above.").arg(name));
        return;
    }
    title_->setText(QStringLiteral("<b>%1</b>").arg(name));
    const PunctualLight& lamp = scene->lights[static_cast<std::size_t>(light_)];
    const bool isSun = lamp.kind == PunctualLight::Kind::directional, isSpot = lamp.kind == PunctualLight::Kind::spot;
    for (QDoubleSpinBox* field : {x_, y_, z_}) rows_->setRowVisible(field, !isSun);
    for (QDoubleSpinBox* field : {turn_, tilt_}) rows_->setRowVisible(field, isSun || isSpot);
    for (QDoubleSpinBox* field : {inner_, outer_}) rows_->setRowVisible(field, isSpot);
    filling_ = true;
    const glm::dvec3 place = scene->toFile(lamp.position);
    x_->setValue(place.x), y_->setValue(place.y), z_->setValue(place.z);
    const glm::dvec2 angles = anglesOf(lamp.travel);
    turn_->setValue(angles.x), tilt_->setValue(angles.y);
    intensity_->setSuffix(isSun ? tr(" lx") : tr(" cd"));
    intensity_->setValue(static_cast<double>(luminance(lamp.intensity)));
    inner_->setValue(glm::degrees(static_cast<double>(lamp.innerCone)));
    outer_->setValue(glm::degrees(static_cast<double>(lamp.outerCone)));
    if (luminance(lamp.intensity) > 0.0f) tints_[light_] = lamp.intensity / luminance(lamp.intensity);
    showColour();
    filling_ = false;
}

/// Only what was typed is taken over: the other fields are rounded.
void LampEditor::tell(const QString& what)
{
    if (light_ < 0) return;
    PunctualLight lamp = scene_->lights[static_cast<std::size_t>(light_)];
    const auto* field = static_cast<QDoubleSpinBox*>(sender());
    const double value = field->value();
    if (field == x_ || field == y_ || field == z_) {
        glm::dvec3 place = scene_->toFile(lamp.position);
        (field == x_ ? place.x : field == y_ ? place.y : place.z) = value;
        lamp.position = scene_->toScene(place);
    } else if (field == turn_ || field == tilt_) {
        glm::dvec2 angles = anglesOf(lamp.travel);
        (field == turn_ ? angles.x : angles.y) = value;
        lamp.travel = travelOf(angles.x, angles.y);
    } else if (field == inner_ || field == outer_) {
        // one cone pushes the other along
        const auto cone = static_cast<float>(glm::radians(value));
        if (field == inner_) lamp.outerCone = std::min(std::max(lamp.outerCone, cone / kWidestInner), kRightAngle);
        if (field == outer_) lamp.outerCone = cone;
        lamp.innerCone = std::min(field == inner_ ? cone : lamp.innerCone, kWidestInner * lamp.outerCone);
    } else {
        lamp.intensity = tint() * static_cast<float>(value);
    }
    Q_EMIT edited(light_, lamp, what);
}

void LampEditor::chooseColour()
{
    auto* dialog = new QColorDialog(shownColour(tint()), this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    connect(dialog, &QColorDialog::colorSelected, this, [this, light = light_](const QColor& colour) {
        if (light != light_ || light_ < 0) return; // another lamp was chosen meanwhile
        const glm::vec3 linear(toLinear(colour.redF()), toLinear(colour.greenF()), toLinear(colour.blueF()));
        if (!(luminance(linear) > 0.0f)) return; // black is no tint: the dimmer switches off
        PunctualLight lamp = scene_->lights[static_cast<std::size_t>(light_)];
        tints_[light] = linear / luminance(linear);
        lamp.intensity = tints_[light] * luminance(lamp.intensity);
        Q_EMIT edited(light_, lamp, tr("colour"));
    });
    dialog->open();
}

glm::vec3 LampEditor::tint() const
{
    const auto known = tints_.find(light_);
    return known != tints_.end() ? known->second : glm::vec3(1.0f);
}

void LampEditor::showColour()
{
    QPixmap swatch(24, 14);
    swatch.fill(shownColour(tint()));
    colour_->setIcon(QIcon(swatch));
}

} // namespace lightloom
