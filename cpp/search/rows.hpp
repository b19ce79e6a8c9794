// Rows of equal length in blocks that never move, however many rows there are.
#pragma once

#include <bit>
#include <cstddef>
#include <memory>
#include <vector>

namespace explicable {

template <class T>
class Rows {
public:
    explicit Rows(std::size_t width = 1) : width_(width) {
        while (rows_per_block_ < 4096 && rows_per_block_ * width_ * sizeof(T) < 65536) rows_per_block_ *= 2;
        shift_ = std::countr_zero(rows_per_block_);
    }

    T* row(std::size_t index) {
        return blocks_[index >> shift_].get() + (index & (rows_per_block_ - 1)) * width_;
    }
    const T* row(std::size_t index) const { return const_cast<Rows&>(*this).row(index); }
    T* append() {
        if (size_ == blocks_.size() * rows_per_block_) blocks_.emplace_back(new T[rows_per_block_ * width_]);
        return row(size_++);
    }
    std::size_t size() const { return size_; }
    std::size_t memory_bytes() const { return blocks_.size() * rows_per_block_ * width_ * sizeof(T); }

private:
    std::size_t width_, rows_per_block_ = 1, size_ = 0;
    int shift_ = 0;
    std::vector<std::unique_ptr<T[]>> blocks_;
};

}  // namespace explicable
