// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/bake_view.h"
#include <QScrollArea>
#include <vector>

class QHBoxLayout;
class QLabel;
class QMenu;
class QPushButton;
class QToolButton;

namespace lightloom {

/// The refinements of the running or last bake, oldest first. The newest is shown until the user clicks another one;
/// clicking the newest follows again. Where it is narrow the title goes first, then times but that of the one shown,
/// then the oldest into a menu.
class SnapshotBar final : public QScrollArea {
    Q_OBJECT
public:
    explicit SnapshotBar(QWidget* parent = nullptr);
    void clear();
    void add(const BakeView& view);
    /// The shown snapshot under a new mix takes the place of the old one.
    void replaceShown(const BakeView& view);
    /// Null while there is none.
    [[nodiscard]] const BakeView* shown() const;
    [[nodiscard]] int count() const { return static_cast<int>(views_.size()); }
    [[nodiscard]] QSize sizeHint() const override; ///< all in a row

Q_SIGNALS:
    void chosen(); ///< `shown()` is another one

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    /// A snapshot's button and what stands on it where there is room and where there is not.
    struct Entry {
        QToolButton* button;
        QString whole, brief;
        int wholeWidth = 0, briefWidth = 0;
    };
    static void tell(Entry& entry, const BakeView& view);
    void choose(std::size_t index);
    void makeRoom();
    [[nodiscard]] int widthOf(bool isBrief, std::size_t first) const;
    void fillMenu();

    QHBoxLayout* row_;
    QLabel *title_, *empty_;
    QMenu* olderMenu_;
    QPushButton* older_; ///< opens it
    std::vector<BakeView> views_;
    std::vector<Entry> entries_;
    std::size_t shown_ = 0;
};

} // namespace lightloom
