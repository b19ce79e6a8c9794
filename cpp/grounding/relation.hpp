// The atoms of one predicate as rows of objects, found by all their arguments or, through indexes, by some.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace explicable::grounding {

using RowId = std::int32_t;

// Chains of rows that agree in the positions `bound`; a bucket may hold rows of other keys unless it is exact.
struct Index {
    std::vector<std::int32_t> bound;
    bool exact = true;
    std::vector<RowId> head;  // one a bucket; a power of two if not exact
    std::vector<RowId> next;  // one a row
    std::int32_t num_rows = 0;
};

class Relation {
public:
    Relation(std::int32_t arity, std::int32_t num_objects) : arity_(arity), num_objects_(num_objects) {}

    std::int32_t size() const { return size_; }
    std::int32_t arity() const { return arity_; }
    const std::int32_t* row(RowId row) const { return arguments_.data() + std::size_t(row) * arity_; }

    RowId find(const std::int32_t* arguments) const {
        return slots_.empty() ? -1 : slots_[find_slot(arguments)];
    }
    // The row of these arguments and whether it is new.
    std::pair<RowId, bool> insert(const std::int32_t* arguments) {
        if (std::size_t(size_ + 1) * 3 > slots_.size() * 2) grow();
        const std::size_t slot = find_slot(arguments);
        if (slots_[slot] >= 0) return {slots_[slot], false};
        arguments_.insert(arguments_.end(), arguments, arguments + arity_);
        slots_[slot] = size_;
        return {size_++, true};
    }

    // The number of the index on these positions; rows enter it by `index_row`.
    std::int32_t make_index(const std::vector<std::int32_t>& bound) {
        for (std::size_t i = 0; i < indexes_.size(); ++i)
            if (indexes_[i].bound == bound) return static_cast<std::int32_t>(i);
        Index index;
        index.bound = bound;
        index.exact = bound.size() <= 1;
        index.head.assign(bound.empty() ? 1 : bound.size() == 1 ? num_objects_ : 64, -1);
        indexes_.push_back(std::move(index));
        return static_cast<std::int32_t>(indexes_.size()) - 1;
    }
    void index_row(RowId row) {
        for (Index& index : indexes_) {
            if (!index.exact && std::size_t(index.num_rows) >= index.head.size()) widen(index);
            if (index.next.size() <= std::size_t(row)) index.next.resize(std::max<std::size_t>(row + 1, size_), -1);
            chain(index, row);
            ++index.num_rows;
        }
    }
    const Index& index(std::int32_t number) const { return indexes_[number]; }
    // First row of the chain for a key: one object for each bound position.
    RowId first(const Index& index, const std::int32_t* key) const {
        return index.head[bucket(index, [&](std::size_t i) { return key[i]; })];
    }

    std::size_t memory_bytes() const {
        std::size_t bytes = 4 * (arguments_.capacity() + slots_.capacity());
        for (const Index& index : indexes_) bytes += 4 * (index.head.capacity() + index.next.capacity());
        return bytes;
    }

private:
    template <class ValueAt>
    static std::size_t hash(std::size_t number, ValueAt value_at) {
        std::uint64_t h = number;
        for (std::size_t i = 0; i < number; ++i) {
            h = (h ^ static_cast<std::uint32_t>(value_at(i))) * 0x9E3779B97F4A7C15u;
            h ^= h >> 32;
        }
        return h;
    }
    std::size_t hash(const std::int32_t* arguments) const {
        return hash(arity_, [&](std::size_t i) { return arguments[i]; });
    }
    // The bucket of a key whose i-th object is key_at(i).
    template <class KeyAt>
    static std::size_t bucket(const Index& index, KeyAt key_at) {
        if (index.bound.empty()) return 0;
        if (index.exact) return key_at(0);
        return hash(index.bound.size(), key_at) & (index.head.size() - 1);
    }
    std::size_t find_slot(const std::int32_t* arguments) const {
        std::size_t slot = hash(arguments) & (slots_.size() - 1);
        while (slots_[slot] >= 0 && !std::equal(arguments, arguments + arity_, row(slots_[slot])))
            slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }
    void grow() {
        slots_.assign(std::max<std::size_t>(16, slots_.size() * 2), -1);
        for (RowId r = 0; r < size_; ++r) {
            std::size_t slot = hash(row(r)) & (slots_.size() - 1);
            while (slots_[slot] >= 0) slot = (slot + 1) & (slots_.size() - 1);
            slots_[slot] = r;
        }
    }
    void chain(Index& index, RowId row_id) {
        const std::int32_t* arguments = row(row_id);
        RowId& head = index.head[bucket(index, [&](std::size_t i) { return arguments[index.bound[i]]; })];
        index.next[row_id] = head;
        head = row_id;
    }
    void widen(Index& index) {
        std::vector<RowId> rows;
        for (const RowId head : index.head)
            for (RowId r = head; r >= 0; r = index.next[r]) rows.push_back(r);
        std::sort(rows.begin(), rows.end());
        index.head.assign(index.head.size() * 4, -1);
        for (const RowId r : rows) chain(index, r);
    }

    std::int32_t arity_, num_objects_, size_ = 0;
    std::vector<std::int32_t> arguments_;
    std::vector<RowId> slots_;
    std::vector<Index> indexes_;
};

}  // namespace explicable::grounding
