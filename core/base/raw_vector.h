// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace lightloom {

/// std::allocator, but `resize` leaves new elements as memory happens to be: for large arrays that several threads
/// fill.
template<class T>
struct RawAllocator : std::allocator<T> {
    template<class U>
    struct rebind {
        using other = RawAllocator<U>;
    };
    template<class U>
    void construct(U* at)
    {
        ::new (static_cast<void*>(at)) U;
    }
    template<class U, class... Values>
    void construct(U* at, Values&&... values)
    {
        std::construct_at(at, std::forward<Values>(values)...);
    }
};

template<class T>
using RawVector = std::vector<T, RawAllocator<T>>;

} // namespace lightloom
