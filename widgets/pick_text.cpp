// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/pick_text.h"
#include "core/base/units.h"
#include <QLocale>
#include <QObject>
#include <cmath>

namespace lightloom {

namespace {

QString numberText(float value)
{
    return QLocale().toString(static_cast<double>(value), 'f', value < 10.0f ? 2 : value < 100.0f ? 1 : 0);
}

QString luxText(glm::vec3 lux) { return numberText(luminance(lux)); }

float luxOf(const PickedEntry& entry, const Vdl& vdl)
{
    return luminance(vdl.colour) * glm::max(0.0f, glm::dot(entry.surface.normal, vdl.toLight));
}

QString facingText(const LeafPick& leaf, std::size_t e)
{
    const glm::vec3 n = leaf.entries[e].surface.normal;
    return QObject::tr("%1 Entry %2, facing %3 %4 %5")
        .arg(static_cast<int>(e) == leaf.answers ? QStringLiteral("\u25b8") : QStringLiteral("  "))
        .arg(e + 1)
        .arg(static_cast<double>(n.x), 0, 'f', 2)
        .arg(static_cast<double>(n.y), 0, 'f', 2)
        .arg(static_cast<double>(n.z), 0, 'f', 2);
}

QStringList leafText(const LeafPick& leaf)
{
    QStringList lines{QObject::tr("Depth %1, cell %2 %3 %4, %5 m wide")
                          .arg(leaf.depth)
                          .arg(leaf.cell.x)
                          .arg(leaf.cell.y)
                          .arg(leaf.cell.z)
                          .arg(static_cast<double>(leaf.high.x - leaf.low.x), 0, 'g', 3)};
    lines += leaf.isLit ? QObject::tr("%1 lx indirect at the point, between neighbours").arg(luxText(leaf.lux))
                        : QObject::tr("No entry answers here");
    for (std::size_t e = 0; e < leaf.entries.size(); ++e) {
        const PickedEntry& entry = leaf.entries[e];
        QStringList lights;
        for (const Vdl& vdl : entry.lights) lights += luxOfText(entry, vdl);
        lines += QObject::tr("%1: %2 lx").arg(facingText(leaf, e), luxText(entry.lux));
        const QString sum = lights.join(QStringLiteral(" + "));
        lines += lights.isEmpty()     ? QObject::tr("     no lights")
                 : lights.size() == 1 ? QObject::tr("     1 light: %1 lx").arg(sum)
                                      : QObject::tr("     %1 lights: %2 lx").arg(lights.size()).arg(sum);
    }
    return lines;
}

/// Of clusters that keep to a threshold a place's light is off by so many (RMS; docs/methods/voxel-lightcuts.md).
constexpr float kUsualLeast = 0.6f, kUsualMost = 1.4f;

QStringList cutText(const PickedVoxel& voxel)
{
    const Lightcut& cut = *voxel.cut;
    const float lux = luminance(cut.illuminance), every = luminance(voxel.everyLight);
    const float off = every > 0.0f ? 100.0f * std::abs(lux - every) / every : 0.0f,
                asked = 100.0f * voxel.asked.threshold;
    const auto digit = [](float percent) { return QLocale().toString(static_cast<double>(percent), 'f', 1); };
    QStringList lines{QObject::tr("%1 lx indirect at the point by a lightcut of %L2 clusters, %L3 shadow rays")
                          .arg(numberText(lux))
                          .arg(cut.nodes)
                          .arg(cut.shadowRays),
                      QObject::tr("     %1 lx by all %L2 voxels one by one: the cut is off by %3 %")
                          .arg(numberText(every))
                          .arg(static_cast<qulonglong>(voxel.lights))
                          .arg(digit(off))};
    lines += voxel.asked.mostNodes > 0 && cut.nodes >= voxel.asked.mostNodes
                 ? QObject::tr("     It ended at %L1 clusters (voxel.cut), before they were all within %2 %")
                       .arg(voxel.asked.mostNodes)
                       .arg(static_cast<double>(asked), 0, 'g', 2)
                 : QObject::tr("     Usual are %1 to %2 % at a threshold of %3 %")
                       .arg(digit(kUsualLeast * asked), digit(kUsualMost * asked))
                       .arg(static_cast<double>(asked), 0, 'g', 2);
    return lines;
}

QStringList voxelText(const LeafPick& leaf, const PickedVoxel& voxel)
{
    const float side = leaf.high.x - leaf.low.x;
    QStringList lines{QObject::tr("Voxel %1 %2 %3 of %4 a side, %5 m wide, %6")
                          .arg(leaf.cell.x)
                          .arg(leaf.cell.y)
                          .arg(leaf.cell.z)
                          .arg(voxel.cells)
                          .arg(static_cast<double>(side), 0, 'g', 3)
                          .arg(leaf.entries.size() == 1 ? QObject::tr("1 entry")
                                                        : QObject::tr("%1 entries").arg(leaf.entries.size()))};
    if (voxel.cut) lines += cutText(voxel);
    if (voxel.samples > 0) {
        lines += QObject::tr("%1 lx indirect at the point from %L2 voxels at random")
                     .arg(luxText(voxel.lux))
                     .arg(voxel.samples);
    }
    lines += leaf.isLit ? QObject::tr("%1 lx by the field, between neighbours").arg(luxText(leaf.lux))
                        : QObject::tr("No entry of the field answers here");
    for (std::size_t e = 0; e < leaf.entries.size(); ++e) {
        const PickedVoxel::Entry& entry = voxel.entries[e];
        const float area = leaf.entries[e].surface.area;
        lines += QObject::tr("%1: %2 cm\u00b2, %3 % of a side")
                     .arg(facingText(leaf, e))
                     .arg(static_cast<double>(1e4f * area), 0, 'g', 3)
                     .arg(static_cast<double>(100.0f * area / (side * side)), 0, 'f', 0);
        lines += QObject::tr("     %1 lx direct + %2 lx indirect, sends on %3 lm/m\u00b2")
                     .arg(luxText(entry.direct), luxText(entry.indirect), luxText(entry.radiosity));
    }
    return lines;
}

QStringList gridText(const PickedGrid& grid)
{
    const glm::ivec3 cells = grid.lattice.cells;
    const glm::vec3 size = grid.lattice.cellSize;
    const auto metres = [](float m) { return QLocale().toString(static_cast<double>(m), 'g', 3); };
    QStringList lines{(grid.isInside ? QObject::tr("Finer grid inside, %1 x %2 x %3 cells of %4 x %5 x %6 m")
                                     : QObject::tr("Grid of %1 x %2 x %3 cells of %4 x %5 x %6 m"))
                          .arg(cells.x)
                          .arg(cells.y)
                          .arg(cells.z)
                          .arg(metres(size.x), metres(size.y), metres(size.z))};
    if (!grid.isLit) return lines += QObject::tr("No vertex in the open lights this point");
    const float lux = luminance(grid.lux);
    QString here = QObject::tr("%1 lx indirect at the point").arg(numberText(lux));
    if (grid.noise >= 0.0f && lux > 0.0f) {
        here += QObject::tr(", noise %1 lx (%2 %)")
                    .arg(numberText(grid.noise))
                    .arg(static_cast<double>(100.0f * grid.noise / lux), 0, 'f', 1);
    }
    lines += here;
    lines += QObject::tr("     from %n vertices", nullptr, static_cast<int>(grid.vertices.size()));
    lines += QObject::tr("Just before it, on what faces");
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(2 * axis);
        lines += QStringLiteral("     -%1  %2 lx,  +%1  %3 lx")
                     .arg(QLatin1Char("xyz"[axis]))
                     .arg(luxText(grid.around[i]), luxText(grid.around[i + 1]));
    }
    return lines;
}

} // namespace

QString luxOfText(const PickedEntry& entry, const Vdl& vdl) { return numberText(luxOf(entry, vdl)); }

QStringList pickText(const PickedLeaf& picked)
{
    if (picked.grid) return gridText(*picked.grid);
    if (!picked.leaf) return {QObject::tr("No cell with light here")};
    QStringList lines = picked.voxel ? voxelText(*picked.leaf, *picked.voxel) : leafText(*picked.leaf);
    if (!picked.photons.empty()) {
        lines += QObject::tr("%L1 photons gathered for it").arg(static_cast<qulonglong>(picked.photons.size()));
    }
    return lines;
}

} // namespace lightloom
