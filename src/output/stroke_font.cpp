#include "output/stroke_font.h"

#include <algorithm>
#include <array>

namespace kadr {
namespace {

/// Strokes are separated by a space; each point is two digits, x and y.
struct Row {
    char letter;
    const char* strokes;
};

constexpr Row kRows[] = {
    {' ', ""}, {'!', "0004 06"}, {'\'', "0002"}, {'(', "10010516"}, {')', "00111506"}, {'*', "2125 0343 0145 0541"},
    {'+', "2125 0343"}, {',', "0607"}, {'-', "0333"}, {'.', "06"}, {'/', "0640"}, {':', "03 06"},
    {'<', "410345"}, {'=', "0242 0444"}, {'>', "014305"}, {'_', "0747"}, {'|', "0007"}, {'#', "1016 3036 0242 0444"},
    {'0', "103041453616050110"}, {'1', "011016 0626"}, {'2', "01103041420646"}, {'3', "0110304142334445361605 1333"},
    {'4', "36300444"}, {'5', "400002324345361605"}, {'6', "413010010516364543321203"}, {'7', "004016"},
    {'8', "103041423313020110 13040516364544 3344"}, {'9', "051636454130100103144443"},
    {'A', "062046 1434"}, {'B', "0006 003041423303 3344453606"}, {'C', "4130100105163645"}, {'D', "0006 002042442606"},
    {'E', "40000646 0333"}, {'F', "400006 0333"}, {'G', "41301001051636454323"}, {'H', "0006 4046 0343"},
    {'I', "0020 1016 0626"}, {'J', "4045361605"}, {'K', "0006 4003 0346"}, {'L', "000646"}, {'M', "0600234046"},
    {'N', "06004640"}, {'O', "103041453616050110"}, {'P', "06003041423303"}, {'Q', "103041453616050110 3446"},
    {'R', "06003041423303 2346"}, {'S', "413010010213334445361605"}, {'T', "0040 2026"}, {'U', "000516364540"},
    {'V', "002640"}, {'W', "0016223640"}, {'X', "0046 4006"}, {'Y', "002340 2326"}, {'Z', "00400646"},
    {'a', "12324346 441405163645"}, {'b', "0006 0312324345361605"}, {'c', "4332120305163645"},
    {'d', "4046 4332120305163645"}, {'e', "04444332120305163645"}, {'f', "31201116 0232"},
    {'g', "4332120305163645 4247381807"}, {'h', "0006 0312324346"}, {'i', "0206 00"}, {'j', "22271807 20"},
    {'k', "0006 4204 2346"}, {'l', "000516"}, {'m', "0206 03122326 23324346"}, {'n', "0206 0312324346"},
    {'o', "123243453616050312"}, {'p', "0208 0312324345361605"}, {'q', "4248 4332120305163645"}, {'r', "0206 03123243"},
    {'s', "43321203143445361605"}, {'t', "10152636 0232"}, {'u', "0205163645 4246"}, {'v', "022642"},
    {'w', "0216233642"}, {'x', "0246 0642"}, {'y', "0226 4208"}, {'z', "02420646"},
};

constexpr const char* kBox = "0040460600";

Glyph read(std::string_view strokes) {
    Glyph glyph;
    while (!strokes.empty()) {
        const std::size_t end = std::min(strokes.find(' '), strokes.size());
        glyph.emplace_back();
        for (std::size_t i = 0; i + 1 < end; i += 2) glyph.back().emplace_back(strokes[i] - '0', strokes[i + 1] - '0');
        strokes.remove_prefix(std::min(end + 1, strokes.size()));
    }
    return glyph;
}

std::array<Glyph, 128> read_all() {
    std::array<Glyph, 128> glyphs;
    glyphs.fill(read(kBox));
    for (const Row& row : kRows) glyphs[static_cast<std::size_t>(row.letter)] = read(row.strokes);
    return glyphs;
}

}  // namespace

int advance_of(char letter) {
    constexpr int kSpace = 3, kGap = 2;
    int width = -1;
    for (const auto& points : glyph_of(letter))
        for (const glm::ivec2& point : points) width = std::max(width, point.x);
    return width < 0 ? kSpace : width + kGap;
}

const Glyph& glyph_of(char letter) {
    static const std::array<Glyph, 128> kGlyphs = read_all();
    const unsigned code = static_cast<unsigned char>(letter);
    return kGlyphs[code < kGlyphs.size() ? code : 0];
}

}  // namespace kadr
