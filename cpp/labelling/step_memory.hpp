// What steps of relaxed plans have scored: a search asks about the same steps, and the same pairs of steps, again and again.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "labelling/feature_weights.hpp"
#include "labelling/lanes.hpp"
#include "task/task.hpp"

namespace explicable {

// One place for each key, where the latest is kept. Not thread-safe.
class StepMemory {
public:
    // A step by itself. Four to a cache line: the key's last bits make room for `neighbour`.
    class Own {
    public:
        Own() = default;
        Own(std::uint64_t key, double odds, int neighbour)
            : odds(odds), key_((key & ~kNeighbours) | static_cast<std::uint64_t>(neighbour)) {}
        bool is_of(std::uint64_t key) const { return (key ^ key_) <= kNeighbours; }
        int neighbour() const { return static_cast<int>(key_ & kNeighbours); }  // how the steps beside it see it

        double odds = 0;  // of being inexplicable

    private:
        static constexpr std::uint64_t kNeighbours = 15;
        static_assert(kNumNeighbours <= kNeighbours + 1);
        std::uint64_t key_ = 0;
    };

    // Two steps, one after the other: what their schemas and arguments add to the odds of the two.
    struct alignas(32) Pair {
        std::uint64_t key = ~std::uint64_t{0};
        double odds_of_step = 0, odds_of_last = 0;
    };

    explicit StepMemory(std::size_t num_operators)
        : StepMemory(std::clamp<int>(std::bit_width(kPlacesAnOperator * num_operators), 1, kMostBits)) {}

    // The upper bits of a key are to be well mixed.
    Own& own(std::uint64_t key) { return owns_[key >> own_shift_]; }
    // Such a key of two steps, no two of which have the same.
    static std::uint64_t pair_key(OperatorId last, OperatorId step) {
        return (std::uint64_t{static_cast<std::uint32_t>(last)} << 32 | static_cast<std::uint32_t>(step)) * 0x9E3779B97F4A7C15u;
    }
    Pair& pair(std::uint64_t key) { return pairs_[key >> pair_shift_]; }

private:
    static constexpr std::size_t kPlacesAnOperator = 32;
    static constexpr int kMostBits = 13;  // four tenths of a megabyte in all: more would not stay in a processor's cache

    explicit StepMemory(int bits)
        : own_shift_(64 - bits), pair_shift_(64 - bits), owns_(std::size_t{1} << bits), pairs_(std::size_t{1} << bits) {}

    int own_shift_, pair_shift_;
    std::vector<Own> owns_;
    std::vector<Pair> pairs_;
};

// Lends a memory to one search at a time, and keeps one for the next.
class StepMemories {
public:
    explicit StepMemories(std::size_t num_operators) : num_operators_(num_operators) {}

    std::unique_ptr<StepMemory> lend() {
        {
            const std::scoped_lock lock(mutex_);
            if (kept_) return std::move(kept_);
        }
        return std::make_unique<StepMemory>(num_operators_);
    }
    void take_back(std::unique_ptr<StepMemory> memory) {
        const std::scoped_lock lock(mutex_);
        kept_ = std::move(memory);
    }

private:
    std::size_t num_operators_;
    std::mutex mutex_;
    std::unique_ptr<StepMemory> kept_;
};

}  // namespace explicable
