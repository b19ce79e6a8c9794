// An open list: lowest key first, ties in the order of arrival.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

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
        Bucket& bucket = buckets_[key];
        for (const Entry& entry : entries) bucket.push_back(entry);
        size_ += entries.size();
    }
    Entry pop() {
        const auto first = buckets_.begin();
        const Entry entry = first->second.pop();
        if (first->second.empty()) buckets_.erase(first);
        --size_;
        return entry;
    }
    const Key& lowest() const { return buckets_.begin()->first; }
    bool empty() const { return size_ == 0; }
    std::size_t memory_bytes() const { return size_ * sizeof(Entry) + buckets_.size() * 144; }

private:
    // First in, first out. In a labelled search most keys have a bucket of one entry, so that is to be small.
    class Bucket {
    public:
        bool empty() const { return first_ == entries_.size(); }
        void push_back(const Entry& entry) { entries_.push_back(entry); }
        Entry pop() {
            const Entry entry = entries_[first_++];
            if (2 * first_ > entries_.size() && first_ >= 64) {  // what is left moves up, each entry once on the average
                entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(first_));
                first_ = 0;
            }
            return entry;
        }

    private:
        std::vector<Entry> entries_;
        std::size_t first_ = 0;
    };

    std::map<Key, Bucket> buckets_;
    std::size_t size_ = 0;
};

// The same as a heap: for entries that come one by one, as in eager search, where with a labeller nearly every one has a key
// of its own.
template <class Entry>
class OpenHeap {
public:
    void push(const Key& key, const Entry& entry) {
        heap_.push_back({key, num_arrived_++, entry});
        std::push_heap(heap_.begin(), heap_.end());
    }
    Entry pop() {
        std::pop_heap(heap_.begin(), heap_.end());
        const Entry entry = heap_.back().entry;
        heap_.pop_back();
        return entry;
    }
    const Key& lowest() const { return heap_.front().key; }
    bool empty() const { return heap_.empty(); }
    std::size_t memory_bytes() const { return heap_.capacity() * sizeof(Arrival); }

private:
    struct Arrival {
        Key key;
        std::uint32_t number;
        Entry entry;
        // The standard library's heaps have the greatest on top.
        bool operator<(const Arrival& other) const {
            return key != other.key ? key > other.key : number > other.number;
        }
    };
    std::vector<Arrival> heap_;
    std::uint32_t num_arrived_ = 0;
};

}  // namespace explicable
