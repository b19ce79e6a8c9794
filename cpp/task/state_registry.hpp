// Numbers packed states from 0 in order of insertion; each is stored once, in blocks that are never moved.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "task/packed_state.hpp"

namespace explicable {

using StateId = std::int32_t;

class StateRegistry {
public:
    explicit StateRegistry(std::int32_t num_words) : num_words_(num_words), slots_(1024, empty) {
        while ((std::size_t{num_words_ + 1u} << block_bits_) > (std::size_t{1} << 16) && block_bits_ > 0) --block_bits_;
    }

    std::int32_t size() const { return size_; }
    const Word* operator[](StateId id) const {
        return blocks_[id >> block_bits_].get() + std::size_t(id & block_mask()) * num_words_;
    }

    // The state's number, and whether it is new.
    std::pair<StateId, bool> insert(const Word* state) {
        std::size_t slot = find_slot(state);
        if (slots_[slot] != empty) return {slots_[slot], false};
        if ((size_ & block_mask()) == 0 && std::size_t(size_ >> block_bits_) == blocks_.size())
            // Not set to 0: most searches on small tasks use little of their first block.
            blocks_.push_back(std::make_unique_for_overwrite<Word[]>((std::size_t{1} << block_bits_) * num_words_));
        std::copy_n(state, num_words_, const_cast<Word*>((*this)[size_]));
        slots_[slot] = size_++;
        if (std::size_t(size_) * 4 > slots_.size() * 3) grow();
        return {size_ - 1, true};
    }
    // The state's number, or -1.
    StateId find(const Word* state) const { return slots_[find_slot(state)]; }

    std::size_t memory_bytes() const {
        return blocks_.size() * (std::size_t{1} << block_bits_) * num_words_ * sizeof(Word) +
               slots_.capacity() * sizeof(StateId);
    }

private:
    static constexpr StateId empty = -1;

    StateId block_mask() const { return (StateId{1} << block_bits_) - 1; }

    std::size_t hash(const Word* state) const {
        Word h = 0x9E3779B97F4A7C15u;
        for (std::int32_t i = 0; i < num_words_; ++i) {
            h = (h ^ state[i]) * 0xBF58476D1CE4E5B9u;
            h ^= h >> 29;
        }
        h *= 0x94D049BB133111EBu;
        return h ^ (h >> 32);
    }
    // Where the state is, or the empty slot where it would go.
    std::size_t find_slot(const Word* state) const {
        std::size_t slot = hash(state) & (slots_.size() - 1);
        while (slots_[slot] != empty && !std::equal(state, state + num_words_, (*this)[slots_[slot]]))
            slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }
    void grow() {
        const std::size_t size = slots_.size() * 2;
        slots_ = {};  // freed before the larger table is made
        slots_.assign(size, empty);
        for (StateId id = 0; id < size_; ++id) {
            std::size_t slot = hash((*this)[id]) & (size - 1);
            while (slots_[slot] != empty) slot = (slot + 1) & (size - 1);
            slots_[slot] = id;
        }
    }

    std::int32_t num_words_;
    std::int32_t size_ = 0;
    std::int32_t block_bits_ = 13;
    std::vector<StateId> slots_;  // a power of two, at most three quarters full
    std::vector<std::unique_ptr<Word[]>> blocks_;
};

}  // namespace explicable
