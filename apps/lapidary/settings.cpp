// SPDX-License-Identifier: MIT
#include "apps/lapidary/settings.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "loaders/scene/load.h"

namespace lapidary {

namespace {

// `camera.location=0,1,-5` taken apart.
struct Setting {
    std::vector<std::string> blocks;  // outermost first
    std::string property;
    std::string value;
};

bool is_word(std::string_view text) {
    const auto fits = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    };
    return !text.empty() && std::ranges::all_of(text, fits);
}

std::optional<Setting> take_apart(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) return std::nullopt;
    Setting setting;
    setting.value = text.substr(equals + 1);
    std::string_view target(text.data(), equals);
    for (;;) {
        const std::size_t dot = target.find('.');
        const std::string_view word = target.substr(0, dot);
        if (!is_word(word)) return std::nullopt;
        setting.blocks.emplace_back(word);
        if (dot == std::string_view::npos) break;
        target.remove_prefix(dot + 1);
    }
    setting.property = std::move(setting.blocks.back());
    setting.blocks.pop_back();
    return setting;
}

// A setting as the scene language would write the property, and what was read of it.
struct ReadSetting {
    Document document;
    bool good = false;  // exactly one property; otherwise there is an error
};

ReadSetting read_setting(const std::string& text, const Setting& setting, Messages& messages) {
    const std::size_t errors = messages.errors();
    ReadSetting read{load_scene_text("--set " + text, setting.property + "(" + setting.value + ");", {}, messages)};
    const Items& items = read.document.items;
    read.good = items.size() == 1 && std::holds_alternative<Property>(items.front());
    if (!read.good && messages.errors() == errors)
        messages.error({},
                       "--set " + text + ": '" + setting.value + "' is not what stands between the parentheses of one property");
    return read;
}

Block* as_block(Item& item) {
    const auto* block = std::get_if<std::unique_ptr<Block>>(&item);
    return block ? block->get() : nullptr;
}

// The last block of this keyword, as the last one counts.
Block* find_by_keyword(Items& items, std::string_view keyword) {
    for (auto item = items.rbegin(); item != items.rend(); ++item)
        if (Block* block = as_block(*item); block && block->keyword == keyword) return block;
    return nullptr;
}

// The block that defines a name, at any depth.
Block* find_by_name(Items& items, std::string_view name) {
    for (Item& item : items) {
        Block* const block = as_block(item);
        if (!block) continue;
        if (block->name == name) return block;
        for (Branch& branch : block->branches)
            if (Block* const found = find_by_name(branch.items, name)) return found;
    }
    return nullptr;
}

Block& add_block(Items& items, const std::string& keyword, const Place& place) {
    auto block = std::make_unique<Block>();
    block->keyword = keyword;
    block->place = place;
    block->branches.push_back({place, {}});
    return *std::get<std::unique_ptr<Block>>(items.emplace_back(std::move(block)));
}

// The items that the property belongs among.
Items& find_target(const std::vector<std::string>& path, Document& document, const Place& place) {
    Items* items = &document.items;
    for (const std::string& word : path) {
        Block* block = find_by_keyword(*items, word);
        if (!block) block = find_by_name(*items, word);
        if (!block) block = &add_block(*items, word, place);
        items = &block->branches.front().items;
    }
    return *items;
}

}  // namespace

std::shared_ptr<Sources> apply_setting(const std::string& text, Document& document, Messages& messages) {
    const std::optional<Setting> setting = take_apart(text);
    if (!setting) {
        messages.error({}, "--set takes block.property=value, as in camera.location=0,1,-5, not '" + text + "'");
        return nullptr;
    }
    ReadSetting read = read_setting(text, *setting, messages);
    if (read.good) {
        auto& property = std::get<Property>(read.document.items.front());
        Items& items = find_target(setting->blocks, document, property.place);
        std::erase_if(items, [&](const Item& item) {
            const auto* old = std::get_if<Property>(&item);
            return old && old->keyword == property.keyword;
        });
        items.emplace_back(std::move(property));
    }
    return read.document.sources;
}

}  // namespace lapidary
