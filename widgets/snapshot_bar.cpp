// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/snapshot_bar.h"
#include <QHBoxLayout>
#include <QLabel>
#include <QTimer>
#include <QToolButton>

namespace lightloom {

SnapshotBar::SnapshotBar(QWidget* parent)
    : QScrollArea(parent), row_(new QHBoxLayout), title_(new QLabel(tr("Snapshots:"))),
      empty_(new QLabel(tr("none yet")))
{
    row_->setContentsMargins(8, 2, 8, 2);
    row_->addWidget(title_);
    row_->addWidget(empty_);
    row_->addStretch(1);
    auto* inside = new QWidget;
    inside->setLayout(row_);
    setWidget(inside);
    setWidgetResizable(true);
    setFrameShape(QFrame::NoFrame);
    setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setFixedHeight(QToolButton().sizeHint().height() + fontMetrics().height() + 4); // room for a scroll bar below
    setToolTip(tr("Refinements of this bake. Click one to look at it; the last one follows the bake."));
}

void SnapshotBar::clear()
{
    for (QToolButton* button : buttons_) delete button;
    buttons_.clear();
    views_.clear();
    shown_ = 0;
    empty_->show();
    makeRoom();
}

QSize SnapshotBar::sizeHint() const
{
    int width = row_->sizeHint().width();
    if (title_->isHidden()) width += row_->spacing() + title_->sizeHint().width();
    return {width, height()};
}

void SnapshotBar::makeRoom()
{
    title_->setVisible(width() >= sizeHint().width());
    updateGeometry();
}

void SnapshotBar::add(const BakeView& view)
{
    const bool follows = views_.empty() || shown_ + 1 == views_.size();
    auto* button = new QToolButton;
    tell(*button, view);
    button->setCheckable(true);
    button->setAutoRaise(true);
    const std::size_t index = views_.size();
    views_.push_back(view);
    buttons_.push_back(button);
    row_->insertWidget(row_->count() - 1, button);
    empty_->hide();
    makeRoom();
    connect(button, &QToolButton::clicked, this, [this, index] {
        choose(index);
        Q_EMIT chosen();
    });
    choose(follows ? index : shown_);
    if (follows)
        QTimer::singleShot(0, button, [this, button] { ensureWidgetVisible(button, 0, 0); }); // it has a place then
}

void SnapshotBar::tell(QToolButton& button, const BakeView& view)
{
    const double seconds = view.snapshot.elapsedMs / 1000.0;
    const QString took = tr("%1 s").arg(seconds, 0, 'f', seconds < 10.0 ? 2 : 1);
    button.setText(shortName(view) + QStringLiteral("  ") + took);
    QString tip = (view.snapshot.isFinal ? tr("Final: %1") : tr("Refinement: %1")).arg(fullName(view));
    if (view.noise) tip += tr(", noise %1 % as the bake states it").arg(100.0 * *view.noise, 0, 'f', 1);
    button.setToolTip(tip);
    button.setAccessibleName(tr("Snapshot: %1").arg(fullName(view)));
}

void SnapshotBar::choose(std::size_t index)
{
    shown_ = index;
    for (std::size_t i = 0; i < buttons_.size(); ++i) buttons_[i]->setChecked(i == index);
}

void SnapshotBar::replaceShown(const BakeView& view)
{
    if (shown_ < views_.size() && views_[shown_].snapshot.serial == view.snapshot.serial &&
        views_[shown_].snapshot.level == view.snapshot.level &&
        views_[shown_].snapshot.isRough == view.snapshot.isRough) {
        views_[shown_] = view;
        tell(*buttons_[shown_], view); // another form is another name
    }
}

void SnapshotBar::resizeEvent(QResizeEvent* event)
{
    makeRoom();
    QScrollArea::resizeEvent(event);
    if (shown_ < buttons_.size()) ensureWidgetVisible(buttons_[shown_], 0, 0);
}

const BakeView* SnapshotBar::shown() const { return shown_ < views_.size() ? &views_[shown_] : nullptr; }

} // namespace lightloom
