#include "shot/yaml_document.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>

#include "base/text.h"

namespace kadr {

namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

[[noreturn]] void fail(const YamlPlace& place, std::string found, std::string expected) {
    throw InputError(diagnostic_at(place, std::move(found), std::move(expected)));
}

YamlPlace place_of_offset(const YamlSource& source, std::size_t offset) {
    const auto after = std::upper_bound(source.line_starts.begin(), source.line_starts.end(), offset);
    const auto line = static_cast<int>(after - source.line_starts.begin()) - 1;
    const std::size_t start = source.line_starts[static_cast<std::size_t>(line)];
    return {&source, line, static_cast<int>(offset - start), 1};
}

/// Length of the value that starts at a column, where it ends on the same line.
int value_length(std::string_view line, std::size_t column) {
    if (column >= line.size()) return 1;
    const char first = line[column];
    if (first == '"' || first == '\'') {
        const std::size_t close = line.find(first, column + 1);
        return close == std::string_view::npos ? 1 : static_cast<int>(close - column + 1);
    }
    if (first != '[' && first != '{') return 1;
    int depth = 0;
    for (std::size_t i = column; i < line.size(); ++i) {
        depth += line[i] == '[' || line[i] == '{';
        depth -= line[i] == ']' || line[i] == '}';
        if (depth == 0) return static_cast<int>(i - column + 1);
    }
    return static_cast<int>(line.size() - column);
}

int character_count(std::string_view bytes) {
    return static_cast<int>(std::count_if(bytes.begin(), bytes.end(),
                                          [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

/// Finds where flow brackets nest too deeply. yaml-cpp reads a whole line of brackets ahead before its own guard
/// sees the first, so this looks before. Quotes and comments are told apart well enough for that.
class BracketScan {
public:
    explicit BracketScan(std::string_view text) : text_(text) {}

    std::optional<std::size_t> too_deep() {
        for (; at_ < text_.size(); ++at_) {
            const char c = text_[at_];
            if (c == '#' && space_before())
                skip_to('\n');
            else if ((c == '"' || c == '\'') && starts_value())
                skip_to(c);
            else if (c == '[' || c == '{')
                ++depth_;
            else if ((c == ']' || c == '}') && depth_ > 0)
                --depth_;
            if (depth_ > kDeepestYaml) return at_;
        }
        return std::nullopt;
    }

private:
    bool space_before() const {
        return at_ == 0 || text_[at_ - 1] == ' ' || text_[at_ - 1] == '\t' || text_[at_ - 1] == '\n';
    }
    bool starts_value() const {
        std::size_t i = at_;
        while (i > 0 && text_[i - 1] == ' ') --i;
        return i == 0 || std::string_view(":,[{-?\n").find(text_[i - 1]) != std::string_view::npos;
    }
    void skip_to(char end) {
        at_ = std::min(text_.find(end, at_ + 1), text_.size() - 1);  // unclosed: nothing more to see
    }

    std::string_view text_;
    std::size_t at_ = 0;
    int depth_ = 0;
};

std::size_t node_count(const YamlNode& node) {
    std::size_t count = 1;
    for (const YamlNode& item : node.items) count += node_count(item);
    for (const YamlEntry& entry : node.entries) count += 1 + node_count(entry.value);
    return count;
}

/// Builds the tree from yaml-cpp's events.
class TreeBuilder : public YAML::EventHandler {
public:
    explicit TreeBuilder(const YamlSource& source) : source_(source) {}
    YamlNode take_root() { return std::move(root_); }
    const YamlPlace& document_place() const { return document_place_; }

    void OnDocumentStart(const YAML::Mark& mark) override { document_place_ = place(mark); }
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        finish(make(YamlNode::Kind::null, mark), anchor);
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const auto found = anchors_.find(anchor);
        if (found == anchors_.end())
            fail(place(mark), "an alias stands inside the value it names", "expected an alias of a complete value");
        alias_nodes_ += node_count(found->second);
        if (alias_nodes_ > kMostAliasNodes)
            fail(place(mark), "the aliases expand to a huge document",
                 fmt::format("expected aliases that stand for at most {} values", kMostAliasNodes));
        finish(YamlNode(found->second), 0);
    }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        check_tag(mark, tag);
        YamlNode node = make(YamlNode::Kind::scalar, mark);
        node.quoted = tag == "!";
        node.text = value;
        if (!node.quoted) node.place.length = static_cast<int>(value.size());
        finish(std::move(node), anchor);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open(YamlNode::Kind::list, mark, tag, anchor);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open(YamlNode::Kind::map, mark, tag, anchor);
    }
    void OnMapEnd() override { close(); }

private:
    struct Open {
        YamlNode node;
        YAML::anchor_t anchor;
        std::optional<YamlNode> key;  ///< of a map: read, its value is still to come
    };

    YamlPlace place(const YAML::Mark& mark) const { return {&source_, mark.line, mark.column, 0}; }
    YamlNode make(YamlNode::Kind kind, const YAML::Mark& mark) {
        if (++nodes_ > kMostYamlNodes)
            fail(place(mark), fmt::format("there are more than {} values", kMostYamlNodes), "expected a smaller file");
        YamlNode node;
        node.kind = kind;
        node.place = place(mark);
        return node;
    }
    void check_tag(const YAML::Mark& mark, const std::string& tag) const {
        if (!tag.empty() && tag != "?" && tag != "!")
            fail(place(mark), fmt::format("the tag '{}' is not part of the format", tag),
                 "expected a value without a tag");
    }
    void open(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
        check_tag(mark, tag);
        if (open_.size() >= static_cast<std::size_t>(kDeepestYaml))
            fail(place(mark), "the values nest too deeply", fmt::format("expected at most {} levels", kDeepestYaml));
        open_.push_back({make(kind, mark), anchor, std::nullopt});
    }
    void close() {
        Open done = std::move(open_.back());
        open_.pop_back();
        finish(std::move(done.node), done.anchor);
    }
    void finish(YamlNode node, YAML::anchor_t anchor) {
        if (anchor != 0) remember(anchor, node);
        if (open_.empty()) {
            root_ = std::move(node);
            return;
        }
        Open& parent = open_.back();
        if (parent.node.kind == YamlNode::Kind::list) {
            parent.node.items.push_back(std::move(node));
        } else if (!parent.key) {
            if (node.kind == YamlNode::Kind::null)
                node.text = "null";
            else if (!node.is_scalar())
                fail(node.place, "a key is not a plain word", "expected `key: value`");
            parent.key = std::move(node);
        } else {
            if (node.kind == YamlNode::Kind::null)
                node.place = parent.key->place;  // what is missing has no place of its own
            parent.node.entries.push_back({std::move(*parent.key), std::move(node)});
            parent.key.reset();
        }
    }
    void remember(YAML::anchor_t anchor, const YamlNode& node) {
        nodes_ += node_count(node);
        if (nodes_ > kMostYamlNodes)
            fail(node.place, fmt::format("there are more than {} values", kMostYamlNodes), "expected a smaller file");
        anchors_[anchor] = node;
    }

    const YamlSource& source_;
    YamlNode root_;
    YamlPlace document_place_;
    std::vector<Open> open_;
    std::map<YAML::anchor_t, YamlNode> anchors_;
    std::size_t nodes_ = 0, alias_nodes_ = 0;
};

void check_text(const YamlSource& source) {
    if (source.text.size() > kMostYamlBytes) {
        fail({&source, -1, 0, 0}, fmt::format("the file has {} bytes", source.text.size()),
             fmt::format("expected a shot file of at most {} MiB", kMostYamlBytes >> 20));
    }
    if (const auto bad = first_invalid_utf8(source.text)) {
        // The line itself cannot be shown: its bytes are not text.
        YamlPlace place = place_of_offset(source, *bad);
        Diagnostic diagnostic;
        diagnostic.where = location_of(place);
        diagnostic.found = fmt::format("byte 0x{:02X} is not UTF-8", static_cast<unsigned char>(source.text[*bad]));
        diagnostic.expected = "expected UTF-8 text; save the file in that encoding";
        throw InputError(std::move(diagnostic));
    }
    if (const std::size_t zero = source.text.find('\0'); zero != std::string::npos)
        fail(place_of_offset(source, zero), "there is a zero byte", "expected text");
    if (const auto deep = BracketScan(source.text).too_deep()) {
        fail(place_of_offset(source, *deep), "the values nest too deeply",
             fmt::format("expected at most {} levels", kDeepestYaml));
    }
}

}  // namespace

YamlSource::YamlSource(std::string_view content, std::string source_name, std::filesystem::path source_folder,
                       bool is_argument)
    : name(std::move(source_name)), folder(std::move(source_folder)), argument(is_argument) {
    if (content.starts_with(kByteOrderMark)) content.remove_prefix(kByteOrderMark.size());
    text = content;
    line_starts.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\n') line_starts.push_back(i + 1);
    }
}

std::string_view YamlSource::line(int index) const {
    if (index < 0 || static_cast<std::size_t>(index) >= line_starts.size()) return {};
    const std::size_t begin = line_starts[static_cast<std::size_t>(index)];
    std::string_view rest = std::string_view(text).substr(begin);
    rest = rest.substr(0, rest.find('\n'));
    return rest.ends_with('\r') ? rest.substr(0, rest.size() - 1) : rest;
}

const YamlNode* YamlNode::find(std::string_view key) const {
    for (const YamlEntry& entry : entries) {
        if (entry.key.text == key) return &entry.value;
    }
    return nullptr;
}

const YamlSource& YamlDocument::add_source(std::string_view text, std::string name, std::filesystem::path folder,
                                           bool argument) {
    sources.push_back(std::make_unique<YamlSource>(text, std::move(name), std::move(folder), argument));
    return *sources.back();
}

YamlNode parse_yaml(const YamlSource& source) {
    check_text(source);
    std::istringstream stream(source.text);
    TreeBuilder builder(source);
    try {
        YAML::Parser parser(stream);
        parser.HandleNextDocument(builder);
        TreeBuilder second(source);
        if (parser.HandleNextDocument(second))
            fail(second.document_place(), "a second document starts here",
                 "expected one shot a file; remove '---' and what follows");
    } catch (const YAML::Exception& error) {
        fail({&source, error.mark.line, error.mark.column, 1}, fmt::format("this is not valid YAML: {}", error.msg),
             "expected `key: value` lines; check brackets, quotes and indentation (spaces, no tabs)");
    }
    return builder.take_root();
}

SourceLocation location_of(const YamlPlace& place) {
    if (!place.source) return {};
    if (place.source->argument || place.line < 0) return {place.source->name, 0, 0};
    const std::string_view line = place.source->line(place.line);
    const auto column = std::min(static_cast<std::size_t>(std::max(place.column, 0)), line.size());
    return {place.source->name, place.line + 1, character_count(line.substr(0, column)) + 1};
}

Diagnostic diagnostic_at(const YamlPlace& place, std::string found, std::string expected) {
    Diagnostic diagnostic;
    diagnostic.where = location_of(place);
    diagnostic.found = std::move(found);
    diagnostic.expected = std::move(expected);
    if (diagnostic.where.line == 0) return diagnostic;
    const std::string_view line = place.source->line(place.line);
    const auto column = std::min(static_cast<std::size_t>(std::max(place.column, 0)), line.size());
    const int bytes = place.length > 0 ? place.length : value_length(line, column);
    diagnostic.excerpt = line;
    diagnostic.excerpt_length = std::max(1, character_count(line.substr(column, static_cast<std::size_t>(bytes))));
    return diagnostic;
}

}  // namespace kadr
