// States packed into 64-bit words: each finite-domain variable has a bit field, no field crosses a word.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <vector>

#include "task/state.hpp"
#include "task/task.hpp"

namespace explicable {

using Word = std::uint64_t;

class StatePacker {
public:
    explicit StatePacker(const Task& task) : fields_(task.num_variables()), tests_(task.num_facts()) {
        place_fields(task);
        for (FactId fact = 0; fact < task.num_facts(); ++fact) {
            const Field& field = fields_[task.fact_variable[fact]];
            tests_[fact] = {field.word, field.mask << field.shift, Word(task.fact_value[fact]) << field.shift};
        }
    }

    std::int32_t num_words() const { return num_words_; }

    std::int32_t get(const Word* state, VariableId variable) const {
        const Field& field = fields_[variable];
        return static_cast<std::int32_t>((state[field.word] >> field.shift) & field.mask);
    }
    void set(Word* state, VariableId variable, std::int32_t value) const {
        const Field& field = fields_[variable];
        Word& word = state[field.word];
        word = (word & ~(field.mask << field.shift)) | (Word(value) << field.shift);
    }
    bool holds(const Word* state, FactId fact) const {
        const Test& test = tests_[fact];
        return (state[test.word] & test.mask) == test.bits;
    }
    void add(Word* state, FactId fact) const {
        const Test& test = tests_[fact];
        state[test.word] = (state[test.word] & ~test.mask) | test.bits;
    }
    void remove(Word* state, FactId fact) const {
        if (holds(state, fact)) state[tests_[fact].word] &= ~tests_[fact].mask;
    }

    // `out` has num_words() words.
    void pack(const State& state, Word* out) const {
        std::fill(out, out + num_words_, Word(0));
        for (VariableId v = 0; v < static_cast<VariableId>(fields_.size()); ++v) set(out, v, state.values[v]);
    }
    State unpack(const Word* packed) const {
        State state;
        unpack(packed, state);
        return state;
    }
    void unpack(const Word* packed, State& state) const {
        state.values.resize(fields_.size());
        for (VariableId v = 0; v < static_cast<VariableId>(fields_.size()); ++v) state.values[v] = get(packed, v);
    }

private:
    struct Field {
        std::int32_t word = 0, shift = 0;
        Word mask = 0;
    };
    struct Test {
        std::int32_t word = 0;
        Word mask = 0, bits = 0;
    };

    // Widest first, each into the first word with room: words that are full are never looked at again.
    void place_fields(const Task& task) {
        std::vector<VariableId> order(fields_.size());
        std::iota(order.begin(), order.end(), 0);
        auto width = [&](VariableId v) {
            return static_cast<std::int32_t>(std::bit_width(static_cast<Word>(task.variable_facts[v].size())));
        };
        std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return width(a) > width(b); });
        std::vector<std::int32_t> used;
        std::size_t first_open = 0;
        for (VariableId v : order) {
            const std::int32_t bits = width(v);
            while (first_open < used.size() && used[first_open] == 64) ++first_open;
            std::size_t word = first_open;
            while (word < used.size() && used[word] + bits > 64) ++word;
            if (word == used.size()) used.push_back(0);
            fields_[v] = {static_cast<std::int32_t>(word), used[word], (Word(1) << bits) - 1};
            used[word] += bits;
        }
        num_words_ = static_cast<std::int32_t>(used.size());
    }

    std::vector<Field> fields_;
    std::vector<Test> tests_;
    std::int32_t num_words_ = 0;
};

}  // namespace explicable
