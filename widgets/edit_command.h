// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <QUndoCommand>
#include <chrono>
#include <functional>
#include <utility>

namespace lightloom {

/// A change of a value that was made already and can be taken back: `apply` shows and uses a value. Changes with the
/// same `merge` number (not negative) that follow within a second are one step: a slider that is dragged, say.
template<class T>
class EditCommand final : public QUndoCommand {
public:
    EditCommand(const QString& text, T before, T after, std::function<void(const T&)> apply, int merge)
        : QUndoCommand(text), before_(std::move(before)), after_(std::move(after)), apply_(std::move(apply)),
          merge_(merge)
    {
    }
    void undo() override { apply_(before_); }
    void redo() override
    {
        if (isDone_) apply_(after_);
        isDone_ = true; // the stack calls this when it takes the command; the user has done it by then
    }
    [[nodiscard]] int id() const override { return merge_; }
    bool mergeWith(const QUndoCommand* next) override
    {
        const auto& later = static_cast<const EditCommand&>(*next); // same id: same kind
        if (later.made_ - made_ > std::chrono::seconds(1)) return false;
        after_ = later.after_;
        made_ = later.made_;
        setObsolete(before_ == after_);
        return true;
    }

private:
    T before_, after_;
    std::function<void(const T&)> apply_;
    int merge_;
    bool isDone_ = false;
    std::chrono::steady_clock::time_point made_ = std::chrono::steady_clock::now();
};

} // namespace lightloom
