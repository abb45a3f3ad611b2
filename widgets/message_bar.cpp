// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/message_bar.h"
#include "widgets/panel_parts.h"
#include <QHBoxLayout>
#include <QLabel>
#include <QToolButton>

namespace lightloom {

MessageBar::MessageBar(QWidget* parent)
    : QFrame(parent), text_(new QLabel), way_(new QToolButton), close_(new QToolButton)
{
    setObjectName(QStringLiteral("messageBar"));
    setFrameShape(QFrame::StyledPanel);
    setAutoFillBackground(true);
    setBackgroundRole(QPalette::AlternateBase);
    text_->setWordWrap(true);
    text_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    text_->setAccessibleName(tr("Message"));
    close_->setText(tr("Dismiss"));
    close_->setAutoRaise(true);
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(8, 3, 4, 3);
    row->addWidget(text_, 1);
    row->addWidget(way_);
    row->addWidget(close_);
    connect(close_, &QToolButton::clicked, this, &MessageBar::clear);
    connect(way_, &QToolButton::clicked, this, [this] {
        const auto go = go_; // it may show another message
        clear();
        if (go) go();
    });
    hide();
}

void MessageBar::show(const QString& text, const QString& way, std::function<void()> go)
{
    message_ = text;
    text_->setText(breakable(text));
    way_->setText(way);
    way_->setVisible(!way.isEmpty());
    go_ = std::move(go);
    setVisible(true);
}

void MessageBar::clear()
{
    message_.clear();
    text_->clear();
    go_ = {};
    hide();
}

QString MessageBar::text() const { return message_; }

} // namespace lightloom
