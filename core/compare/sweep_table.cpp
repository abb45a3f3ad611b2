// SPDX-License-Identifier: Apache-2.0
#include "core/compare/sweep_table.h"
#include "core/base/atomic_file.h"
#include "core/compare/csv_text.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lightloom {
namespace {

constexpr std::uint64_t kMostBytes = 64ull << 20;
constexpr std::string_view kIncomplete = "# incomplete";

/// A count from a file that may say anything.
std::uint64_t whole(double v) { return v >= 0.0 && v < 1e15 ? static_cast<std::uint64_t>(v) : 0; }

/// Where a figure of a row lives, for both directions.
struct Column {
    const char* name;
    double (*get)(const SweepRow&);
    void (*set)(SweepRow&, double);
};
// clang-format off
constexpr std::array kBefore{
    Column{"threads", [](const SweepRow& r) { return double(r.threads); }, [](SweepRow& r, double v) { r.threads = int(std::min(whole(v), std::uint64_t{100'000})); }},
    Column{"wall_s", [](const SweepRow& r) { return r.wallSeconds(); }, [](SweepRow&, double) {}},
    Column{"cpu_s", [](const SweepRow& r) { return r.cpuSeconds(); }, [](SweepRow&, double) {}},
};
constexpr std::array kAfter{
    Column{"process_peak_mib", [](const SweepRow& r) { return r.processPeakMiB; }, [](SweepRow& r, double v) { r.processPeakMiB = v; }},
    Column{"field_mib", [](const SweepRow& r) { return r.fieldMiB; }, [](SweepRow& r, double v) { r.fieldMiB = v; }},
    Column{"relrmse", [](const SweepRow& r) { return r.error.relRmse; }, [](SweepRow& r, double v) { r.error.relRmse = v; }},
    Column{"bias", [](const SweepRow& r) { return r.error.bias; }, [](SweepRow& r, double v) { r.error.bias = v; }},
    Column{"mae", [](const SweepRow& r) { return r.error.mae; }, [](SweepRow& r, double v) { r.error.mae = v; }},
    Column{"p95", [](const SweepRow& r) { return r.error.p95; }, [](SweepRow& r, double v) { r.error.p95 = v; }},
    Column{"max", [](const SweepRow& r) { return r.error.max; }, [](SweepRow& r, double v) { r.error.max = v; }},
    Column{"perpoint", [](const SweepRow& r) { return r.error.perPoint; }, [](SweepRow& r, double v) { r.error.perPoint = v; }},
    Column{"noise", [](const SweepRow& r) { return r.split.noise; }, [](SweepRow& r, double v) { r.split.noise = v; }},
    Column{"systematic", [](const SweepRow& r) { return r.split.systematic; }, [](SweepRow& r, double v) { r.split.systematic = v; }},
    Column{"reference_noise", [](const SweepRow& r) { return r.referenceNoise; }, [](SweepRow& r, double v) { r.referenceNoise = v; }},
    Column{"reference_mean", [](const SweepRow& r) { return r.error.meanReference; }, [](SweepRow& r, double v) { r.error.meanReference = v; }},
    Column{"points", [](const SweepRow& r) { return double(r.error.count); }, [](SweepRow& r, double v) { r.error.count = whole(v); }},
};
// clang-format on

std::vector<const ParamSpec*> paramsOf(Method method)
{
    std::vector<const ParamSpec*> specs;
    for (const ParamSpec& spec : kParams) {
        if (spec.methods & (1u << static_cast<unsigned>(method))) specs.push_back(&spec);
    }
    return specs;
}

std::string lineOf(const SweepRow& row, Method method)
{
    std::string line = fmt::format("{},{}", row.key, methodName(method));
    for (const ParamSpec* spec : paramsOf(method)) line += ',' + paramText(row.params, *spec);
    for (const Column& c : kBefore) line += fmt::format(",{}", c.get(row));
    for (const PartCost& part : row.parts) line += fmt::format(",{},{}", part.wallSeconds, part.cpuSeconds);
    for (const Column& c : kAfter) line += fmt::format(",{}", c.get(row));
    return line + '\n';
}

/// Takes the cells of a line one after another.
class Cells {
public:
    Cells(std::vector<std::string_view> cells, const std::vector<std::string>& columns)
        : cells_(std::move(cells)), columns_(columns)
    {
    }
    std::string_view next() { return cells_[at_++]; }
    double number()
    {
        double value = 0;
        const std::string_view cell = next();
        if (!parseNumber(cell, value) && wrong_.empty()) {
            wrong_ = fmt::format("{} should be a finite number, it is {}", columns_[at_ - 1], shownCell(cell));
        }
        return value;
    }
    [[nodiscard]] const std::string& wrong() const { return wrong_; } ///< empty: all was fine

private:
    std::vector<std::string_view> cells_;
    const std::vector<std::string>& columns_;
    std::size_t at_ = 0;
    std::string wrong_;
};

Result<SweepRow> rowFrom(std::string_view line, const std::vector<std::string>& columns, Method method)
{
    std::vector<std::string_view> parts = cellsOf(line);
    if (parts.size() != columns.size()) {
        return Error{Error::Kind::badInput, fmt::format("expected {} cells, found {}", columns.size(), parts.size())};
    }
    Cells cells(std::move(parts), columns);
    SweepRow row;
    row.key = cells.next();
    if (const std::string_view name = cells.next(); name != methodName(method)) {
        return Error{Error::Kind::badInput,
                     fmt::format("expected method {}, found {}", methodName(method), shownCell(name))};
    }
    for (const ParamSpec* spec : paramsOf(method)) {
        const Result<BakeParams> params = withText(row.params, spec->key, cells.next());
        if (!params) return params.error();
        row.params = *params;
    }
    for (const Column& c : kBefore) c.set(row, cells.number());
    for (PartCost& part : row.parts) part.wallSeconds = cells.number(), part.cpuSeconds = cells.number();
    for (const Column& c : kAfter) c.set(row, cells.number());
    if (!cells.wrong().empty()) return Error{Error::Kind::badInput, cells.wrong()};
    return row;
}

} // namespace

std::vector<std::string> sweepColumns(Method method)
{
    std::vector<std::string> names{"key", "method"};
    for (const ParamSpec* spec : paramsOf(method)) names.emplace_back(spec->key);
    for (const Column& c : kBefore) names.emplace_back(c.name);
    for (const std::string_view part : kSweepPartNames) {
        names.push_back(fmt::format("{}_wall_s", part));
        names.push_back(fmt::format("{}_cpu_s", part));
    }
    for (const Column& c : kAfter) names.emplace_back(c.name);
    return names;
}

std::string sweepText(const std::vector<SweepRow>& rows, Method method, std::optional<std::size_t> wanted)
{
    std::string text = fmt::format("{}\n", fmt::join(sweepColumns(method), ","));
    for (const SweepRow& row : rows) text += lineOf(row, method);
    if (wanted) text += fmt::format("{}: {} rows wanted\n", kIncomplete, *wanted);
    return text;
}

Result<SweepTable> parseSweep(std::string_view csv, Method method)
{
    const bool isBrokenOff = !csv.ends_with('\n');
    CsvLines lines(csv);
    std::string_view line;
    const std::vector<std::string> columns = sweepColumns(method);
    if (!lines.next(line) || line != fmt::format("{}", fmt::join(columns, ","))) {
        return badLine(1, fmt::format("not the columns of a sweep of {} by this program", methodName(method)));
    }
    SweepTable table;
    while (lines.next(line)) {
        if (line.starts_with(kIncomplete)) continue;
        Result<SweepRow> row = rowFrom(line, columns, method);
        // a last number may have lost digits and still be one: without its line end a line cannot be trusted
        if (lines.isAtEnd() && (isBrokenOff || !row)) {
            table.isDamaged = true;
            break;
        }
        if (!row) return badLine(lines.number(), row.error().message);
        table.rows.push_back(*std::move(row));
    }
    return table;
}

Result<SweepTable> resumeSweep(const std::filesystem::path& file, const SweepPlan& plan, const Judge& judge)
{
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return SweepTable{};
    const Result<std::vector<std::uint8_t>> bytes = readFile(file, kMostBytes);
    if (!bytes) return bytes.error();
    if (bytes->empty()) return SweepTable{};
    const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    Result<SweepTable> table = parseSweep(text, plan.method);
    if (!table) {
        return Error{table.error().kind,
                     fmt::format("{} is there already and cannot be gone on with ({}); name another file",
                                 file.string(), table.error().message)};
    }
    const SweepKeys keys(plan, judge);
    for (const SweepRow& row : table->rows) {
        if (row.key == keys.of(row.params)) continue;
        return Error{
            Error::Kind::badInput,
            fmt::format("{} holds rows of another scene, reference or program; name another file", file.string())};
    }
    return table;
}

void sortLike(std::vector<SweepRow>& rows, const std::vector<std::string>& wanted)
{
    std::ranges::stable_sort(rows, {}, [&](const SweepRow& row) {
        return std::ranges::find(wanted, row.key) - wanted.begin(); // not wanted: at the end
    });
}

} // namespace lightloom
