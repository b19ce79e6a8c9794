// What steps of relaxed plans have scored: a search asks about the same step after the same other step again and again.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "labelling/lanes.hpp"

namespace explicable {

// One place for each key, where the latest is kept. Not thread-safe.
class StepMemory {
public:
    struct Place {
        std::uint64_t key = 0;
        double odds_of_last = 0;  // what the step adds to the odds of the one before it being inexplicable
        double odds_of_step = 0;  // its own, but for what the next adds
        std::int32_t neighbour = 0;  // how the steps beside it see it
    };

    explicit StepMemory(std::size_t num_operators)
        : bits_(std::clamp<int>(std::bit_width(kPlacesAnOperator * num_operators), 1, kMostBits)), places_(std::size_t{1} << bits_) {}
    Place& operator[](std::uint64_t key) { return places_[key >> (64 - bits_)]; }
    void prefetch(std::uint64_t key) { prefetch_line(&(*this)[key]); }

private:
    static constexpr std::size_t kPlacesAnOperator = 32;
    static constexpr int kMostBits = 14;  // half a megabyte: more would not stay in a processor's cache
    int bits_;
    std::vector<Place> places_;
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
