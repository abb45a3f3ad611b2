// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/voxel_panel.h"
#include "widgets/panel_parts.h"
#include "widgets/view_worker.h"
#include "widgets/viewport.h"
#include <QFormLayout>
#include <QLabel>
#include <QSpinBox>

namespace lightloom {

VoxelPanel::VoxelPanel(ViewWorker* worker, QWidget* parent)
    : QWidget(parent), worker_(worker), number_(new QSpinBox), about_(textLines())
{
    auto* form = new QFormLayout(this);
    form->setContentsMargins(6, 6, 6, 0);
    number_->setObjectName(QStringLiteral("voxel.lines"));
    number_->setMinimum(-1);
    number_->setSpecialValueText(tr("none"));
    number_->setValue(-1);
    number_->setToolTip(tr("Draws discrete lines of this direction through the scene, and what exchanges light along "
                           "them; the arrow keys go from one direction to the next"));
    form->addRow(tr("Lines of direction"), number_);
    form->addRow(about_);
    about_->hide();
    connect(number_, &QSpinBox::valueChanged, this, &VoxelPanel::ask);
    connect(worker_, &ViewWorker::lined, this, &VoxelPanel::take, Qt::QueuedConnection);
}

int VoxelPanel::direction() const { return number_->value(); }
QString VoxelPanel::aboutText() const { return about_->text(); }

void VoxelPanel::setDirections(int count) { number_->setMaximum(count - 1); }

void VoxelPanel::setView(const BakeView& view)
{
    const bool isSame = view_.snapshot.field == view.snapshot.field;
    view_ = view;
    if (!isSame && direction() >= 0) ask();
}

void VoxelPanel::ask()
{
    if (direction() >= 0 && view_.snapshot.field) return worker_->lines(view_, direction());
    VoxelLineMarks none;
    none.direction = direction();
    take(none);
}

void VoxelPanel::take(const VoxelLineMarks& lines)
{
    if (lines.direction != direction()) return; // asked for before
    about_->setText(lines.about);
    about_->setVisible(!lines.about.isEmpty());
    if (viewport_ != nullptr) viewport_->setLineMarks(lines.marks);
}

} // namespace lightloom
