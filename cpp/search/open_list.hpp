// An open list: lowest key first, ties in the order of arrival.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <utility>

namespace explicable {

// f and, among equal f, h. Greedy search uses h alone.
using Key = std::pair<double, double>;

template <class Entry>
class OpenList {
public:
    void push(const Key& key, const Entry& entry) {
        buckets_[key].push_back(entry);
        ++size_;
    }
    // All of `entries` under one key.
    template <class Entries>
    void push_all(const Key& key, const Entries& entries) {
        if (entries.empty()) return;
        auto& bucket = buckets_[key];
        bucket.insert(bucket.end(), entries.begin(), entries.end());
        size_ += entries.size();
    }
    Entry pop() {
        const auto first = buckets_.begin();
        const Entry entry = first->second.front();
        first->second.pop_front();
        if (first->second.empty()) buckets_.erase(first);
        --size_;
        return entry;
    }
    const Key& lowest() const { return buckets_.begin()->first; }
    bool empty() const { return size_ == 0; }
    std::size_t memory_bytes() const { return size_ * sizeof(Entry) + buckets_.size() * 640; }

private:
    std::map<Key, std::deque<Entry>> buckets_;
    std::size_t size_ = 0;
};

}  // namespace explicable
