// A priority queue for Dijkstra over small integer costs: buckets, and a heap for what exceeds them.
#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace explicable {

// Monotone: what is pushed never costs less than what was popped last.
class CostQueue {
public:
    using Entry = std::pair<std::int32_t, std::int32_t>;  // cost, item

    void clear() {
        for (std::size_t cost = current_; cost < used_; ++cost) buckets_[cost].clear();
        current_ = used_ = 0;
        heap_ = {};
        size_ = 0;
    }
    bool empty() const { return size_ == 0; }
    void push(std::int32_t cost, std::int32_t item) {
        ++size_;
        if (cost >= num_buckets) {
            heap_.emplace(cost, item);
            return;
        }
        const auto bucket = static_cast<std::size_t>(cost);
        if (bucket >= used_) {
            used_ = bucket + 1;
            if (used_ > buckets_.size()) buckets_.resize(used_);
        }
        buckets_[bucket].push_back(item);
    }
    Entry pop() {
        --size_;
        while (current_ < used_ && buckets_[current_].empty()) ++current_;
        if (current_ < used_) {
            auto& bucket = buckets_[current_];
            const std::int32_t item = bucket.back();
            bucket.pop_back();
            return {static_cast<std::int32_t>(current_), item};
        }
        const Entry entry = heap_.top();
        heap_.pop();
        return entry;
    }

private:
    static constexpr std::int32_t num_buckets = 1 << 14;
    std::vector<std::vector<std::int32_t>> buckets_;
    std::size_t current_ = 0, used_ = 0;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> heap_;
    std::size_t size_ = 0;
};

}  // namespace explicable
