// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

namespace lightloom {

/// A vector whose copies share their items until one of them is changed: an edited scene costs nothing for what was not
/// edited. Whoever can change the list gets items of its own first; const access never copies. Copies may be read and
/// dropped on any thread.
template<class T>
class SharedList {
public:
    using value_type = T;
    SharedList() = default;
    SharedList(std::vector<T> items) : items_(std::make_shared<std::vector<T>>(std::move(items))) {}

    [[nodiscard]] const std::vector<T>& all() const { return items_ ? *items_ : none(); }
    /// To change; references and iterators from before may be another list's.
    [[nodiscard]] std::vector<T>& edit()
    {
        if (!items_)
            items_ = std::make_shared<std::vector<T>>();
        else if (items_.use_count() > 1)
            items_ = std::make_shared<std::vector<T>>(*items_);
        return *items_;
    }
    /// True if both are copies of one list and neither was changed since. Lists that only look alike are not.
    [[nodiscard]] bool isSharedWith(const SharedList& other) const { return items_ == other.items_; }

    [[nodiscard]] std::size_t size() const { return all().size(); }
    [[nodiscard]] bool empty() const { return all().empty(); }
    [[nodiscard]] const T& operator[](std::size_t i) const { return all()[i]; }
    [[nodiscard]] const T& at(std::size_t i) const { return all().at(i); }
    [[nodiscard]] const T& front() const { return all().front(); }
    [[nodiscard]] const T& back() const { return all().back(); }
    [[nodiscard]] auto begin() const { return all().begin(); }
    [[nodiscard]] auto end() const { return all().end(); }

    [[nodiscard]] T& operator[](std::size_t i) { return edit()[i]; }
    [[nodiscard]] T& back() { return edit().back(); }
    [[nodiscard]] auto begin() { return edit().begin(); }
    [[nodiscard]] auto end() { return edit().end(); }
    void push_back(T item) { edit().push_back(std::move(item)); }
    void clear() { items_.reset(); }

private:
    static const std::vector<T>& none()
    {
        static const std::vector<T> empty;
        return empty;
    }
    std::shared_ptr<std::vector<T>> items_;
};

} // namespace lightloom
