// Eight 16-bit numbers at a time: as one register where the processor surely has it, else one by one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace explicable {

inline constexpr std::size_t kLanes = 8;

inline void prefetch_line([[maybe_unused]] const void* address) {
#if defined(__SSE2__)
    _mm_prefetch(static_cast<const char*>(address), _MM_HINT_T0);
#endif
}

#if defined(__SSE2__)

class Lanes {
public:
    explicit Lanes(const std::int16_t* values) : all_(_mm_loadu_si128(reinterpret_cast<const __m128i*>(values))) {}
    explicit Lanes(std::int16_t value) : all_(_mm_set1_epi16(value)) {}
    Lanes operator|(Lanes other) const { return Lanes(_mm_or_si128(all_, other.all_)); }
    Lanes where_equal(Lanes other) const { return Lanes(_mm_and_si128(_mm_cmpeq_epi16(all_, other.all_), all_)); }
    Lanes plus(Lanes other) const { return Lanes(_mm_adds_epi16(all_, other.all_)); }  // at most 0x7FFF
    Lanes min(Lanes other) const { return Lanes(_mm_min_epi16(all_, other.all_)); }
    std::int16_t least() const {
        __m128i m = _mm_min_epi16(all_, _mm_shuffle_epi32(all_, 0x4E));
        m = _mm_min_epi16(m, _mm_shuffle_epi32(m, 0xB1));
        m = _mm_min_epi16(m, _mm_srli_epi32(m, 16));
        return static_cast<std::int16_t>(_mm_cvtsi128_si32(m));
    }

private:
    explicit Lanes(__m128i all) : all_(all) {}
    __m128i all_;
};

// Bit 8 * i + j: mine[i] is theirs[j] and not negative.
inline std::uint64_t equal_fours(const std::int32_t* mine, const std::int32_t* theirs) {
    const __m128i other = _mm_loadu_si128(reinterpret_cast<const __m128i*>(theirs));
    std::uint64_t equal = 0;
    for (int i = 0; i < 4; ++i) {
        const auto row = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(_mm_set1_epi32(mine[i]), other)));
        if (mine[i] >= 0) equal |= std::uint64_t(row) << (8 * i);
    }
    return equal;
}

#else

class Lanes {
public:
    explicit Lanes(const std::int16_t* values) { std::copy_n(values, kLanes, all_); }
    explicit Lanes(std::int16_t value) { std::fill_n(all_, kLanes, value); }
    Lanes operator|(Lanes other) const { return map(other, [](int a, int b) { return a | b; }); }
    Lanes where_equal(Lanes other) const { return map(other, [](int a, int b) { return a == b ? a : 0; }); }
    Lanes plus(Lanes other) const { return map(other, [](int a, int b) { return std::min(a + b, 0x7FFF); }); }
    Lanes min(Lanes other) const { return map(other, [](int a, int b) { return std::min(a, b); }); }
    std::int16_t least() const { return *std::min_element(all_, all_ + kLanes); }

private:
    std::int16_t all_[kLanes];
    template <class F>
    Lanes map(const Lanes& other, F f) const {
        Lanes result(std::int16_t{0});
        for (std::size_t i = 0; i < kLanes; ++i) result.all_[i] = static_cast<std::int16_t>(f(all_[i], other.all_[i]));
        return result;
    }
};

inline std::uint64_t equal_fours(const std::int32_t* mine, const std::int32_t* theirs) {
    std::uint64_t equal = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) equal |= std::uint64_t{mine[i] == theirs[j] && mine[i] >= 0} << (8 * i + j);
    return equal;
}

#endif

// The same of eight each.
inline std::uint64_t equal_eights(const std::int32_t* mine, const std::int32_t* theirs) {
    return equal_fours(mine, theirs) | equal_fours(mine, theirs + 4) << 4 | equal_fours(mine + 4, theirs) << 32 |
           equal_fours(mine + 4, theirs + 4) << 36;
}

}  // namespace explicable
