// Eight 16-bit numbers at a time, or two of double precision: as one register where the processor surely has it, else one by one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace explicable {

inline constexpr std::size_t kLanes = 8;

using Two [[gnu::vector_size(16)]] = double;

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
    // 0x7FFF where the bit of a lane is 0, else 0.
    static Lanes where_clear(unsigned bits) {
        const __m128i own = _mm_set_epi16(128, 64, 32, 16, 8, 4, 2, 1);
        const __m128i set = _mm_and_si128(_mm_set1_epi16(static_cast<std::int16_t>(bits)), own);
        return Lanes(_mm_srli_epi16(_mm_cmpeq_epi16(set, _mm_setzero_si128()), 1));
    }
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

// A bit for each of four numbers: whether it equals `value`.
inline unsigned equal_in_four(std::int32_t value, const std::int32_t* four) {
    const __m128i all = _mm_loadu_si128(reinterpret_cast<const __m128i*>(four));
    return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(_mm_set1_epi32(value), all))));
}

#else

class Lanes {
public:
    explicit Lanes(const std::int16_t* values) { std::copy_n(values, kLanes, all_); }
    explicit Lanes(std::int16_t value) { std::fill_n(all_, kLanes, value); }
    // 0x7FFF where the bit of a lane is 0, else 0.
    static Lanes where_clear(unsigned bits) {
        Lanes result(std::int16_t{0});
        for (std::size_t i = 0; i < kLanes; ++i) result.all_[i] = (bits >> i & 1) ? 0 : 0x7FFF;
        return result;
    }
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

inline unsigned equal_in_four(std::int32_t value, const std::int32_t* four) {
    unsigned equal = 0;
    for (int i = 0; i < 4; ++i) equal |= static_cast<unsigned>(four[i] == value) << i;
    return equal;
}

#endif

}  // namespace explicable
