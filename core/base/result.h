// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace lightloom {

/// Why an operation gave nothing. Shown to the user as it stands.
struct Error {
    enum class Kind { badInput, notFound, unsupported, outOfMemory, io, cancelled };
    Kind kind = Kind::badInput;
    std::string message; ///< one sentence: what was asked, what was found, what to do; values included

    /// The same error with the place it happened in front; callers add places on the way up.
    [[nodiscard]] Error in(const std::string& place) const { return {kind, place + ": " + message}; }
};

struct Done {}; ///< the value of an operation that only succeeds or fails

/// A value, or the reason there is none. `*` and `->` need a value (asserted), `error()` needs none.
template<class T>
class [[nodiscard]] Result {
public:
    Result(T value) : held_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : held_(std::in_place_index<1>, std::move(error)) {}

    explicit operator bool() const { return held_.index() == 0; }
    const T& operator*() const& { return value(); }
    T& operator*() & { return const_cast<T&>(value()); }
    T&& operator*() && { return std::move(const_cast<T&>(value())); }
    const T* operator->() const { return &value(); }
    T* operator->() { return &const_cast<T&>(value()); }
    const Error& error() const
    {
        assert(held_.index() == 1);
        return *std::get_if<1>(&held_);
    }

private:
    const T& value() const
    {
        assert(held_.index() == 0);
        return *std::get_if<0>(&held_);
    }
    std::variant<T, Error> held_;
};

} // namespace lightloom
