// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/snapshot_bar.h"
#include <QHBoxLayout>
#include <QLabel>
#include <QMenu>
#include <QPushButton>
#include <QToolButton>
#include <utility>

namespace lightloom {

SnapshotBar::SnapshotBar(QWidget* parent)
    : QScrollArea(parent), row_(new QHBoxLayout), title_(new QLabel(tr("Snapshots:"))),
      empty_(new QLabel(tr("none yet"))), olderMenu_(new QMenu(this)), older_(new QPushButton(QStringLiteral("…")))
{
    row_->setContentsMargins(8, 2, 8, 2);
    row_->addWidget(title_);
    row_->addWidget(empty_);
    row_->addWidget(older_);
    row_->addStretch(1);
    older_->setFlat(true);
    older_->setFixedWidth(fontMetrics().horizontalAdvance(older_->text()) + 2 * fontMetrics().height()); // and an arrow
    older_->setMenu(olderMenu_);
    older_->setAccessibleName(tr("Older snapshots"));
    older_->setToolTip(tr("Refinements that there is no room for"));
    older_->hide();
    connect(olderMenu_, &QMenu::aboutToShow, this, &SnapshotBar::fillMenu);
    auto* inside = new QWidget;
    inside->setLayout(row_);
    setWidget(inside);
    setWidgetResizable(true);
    setFrameShape(QFrame::NoFrame);
    setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setFixedHeight(QToolButton().sizeHint().height() + fontMetrics().height() + 4); // as two lines of a legend want
    setToolTip(tr("Refinements of this bake. Click one to look at it; the last one follows the bake."));
}

void SnapshotBar::clear()
{
    for (const Entry& entry : entries_) delete entry.button;
    entries_.clear();
    views_.clear();
    shown_ = 0;
    empty_->show();
    makeRoom();
}

/// Of the row without its title, from entry `first` on; the one that is shown is whole in any case.
int SnapshotBar::widthOf(bool isBrief, std::size_t first) const
{
    const QMargins margins = row_->contentsMargins();
    int width = margins.left() + margins.right() + (empty_->isHidden() ? 0 : empty_->sizeHint().width());
    if (first > 0) width += older_->minimumWidth() + row_->spacing();
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        if (i < first && i != shown_) continue;
        width += row_->spacing() + (isBrief && i != shown_ ? entries_[i].briefWidth : entries_[i].wholeWidth);
    }
    return width;
}

QSize SnapshotBar::sizeHint() const
{
    return {widthOf(false, 0) + row_->spacing() + title_->sizeHint().width(), height()};
}

void SnapshotBar::makeRoom()
{
    title_->setVisible(width() >= sizeHint().width());
    const bool isBrief = width() < widthOf(false, 0);
    std::size_t first = 0;
    while (isBrief && first + 1 < entries_.size() && width() < widthOf(true, first)) ++first;
    older_->setVisible(first > 0);
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const Entry& entry = entries_[i];
        entry.button->setText(isBrief && i != shown_ ? entry.brief : entry.whole);
        entry.button->setVisible(i >= first || i == shown_);
    }
    updateGeometry();
}

void SnapshotBar::fillMenu()
{
    olderMenu_->clear();
    for (const Entry& entry : entries_) {
        if (!entry.button->isHidden()) continue;
        olderMenu_->addAction(entry.whole, entry.button, &QToolButton::click);
    }
}

void SnapshotBar::add(const BakeView& view)
{
    const bool follows = views_.empty() || shown_ + 1 == views_.size();
    auto* button = new QToolButton;
    button->setCheckable(true);
    button->setAutoRaise(true);
    const std::size_t index = views_.size();
    views_.push_back(view);
    entries_.push_back({button, {}, {}});
    tell(entries_.back(), view);
    row_->insertWidget(row_->count() - 1, button);
    empty_->hide();
    connect(button, &QToolButton::clicked, this, [this, index] {
        choose(index);
        Q_EMIT chosen();
    });
    choose(follows ? index : shown_);
}

void SnapshotBar::tell(Entry& entry, const BakeView& view)
{
    const double seconds = view.snapshot.elapsedMs / 1000.0;
    const QString took = tr("%1 s").arg(seconds, 0, 'f', seconds < 10.0 ? 2 : 1);
    entry.brief = shortName(view);
    entry.whole = entry.brief + QStringLiteral("  ") + took;
    for (const auto& [text, width] : {std::pair(&entry.brief, &entry.briefWidth), {&entry.whole, &entry.wholeWidth}}) {
        entry.button->setText(*text);
        *width = entry.button->sizeHint().width();
    }
    QString tip = (view.snapshot.isFinal ? tr("Final: %1, %2") : tr("Refinement: %1, %2")).arg(fullName(view), took);
    if (view.noise) tip += tr(", noise %1 % as the bake states it").arg(100.0 * *view.noise, 0, 'f', 1);
    entry.button->setToolTip(tip);
    entry.button->setAccessibleName(tr("Snapshot: %1").arg(fullName(view)));
}

void SnapshotBar::choose(std::size_t index)
{
    shown_ = index;
    for (std::size_t i = 0; i < entries_.size(); ++i) entries_[i].button->setChecked(i == index);
    makeRoom();
}

void SnapshotBar::replaceShown(const BakeView& view)
{
    if (shown_ < views_.size() && views_[shown_].snapshot.serial == view.snapshot.serial &&
        views_[shown_].snapshot.level == view.snapshot.level &&
        views_[shown_].snapshot.isRough == view.snapshot.isRough) {
        views_[shown_] = view;
        tell(entries_[shown_], view); // another form is another name
        makeRoom();
    }
}

void SnapshotBar::resizeEvent(QResizeEvent* event)
{
    makeRoom();
    QScrollArea::resizeEvent(event);
}

const BakeView* SnapshotBar::shown() const { return shown_ < views_.size() ? &views_[shown_] : nullptr; }

} // namespace lightloom
