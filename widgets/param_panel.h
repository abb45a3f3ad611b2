// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/params/bake_params.h"
#include <QWidget>
#include <vector>

class QLabel;
class QToolButton;
class QComboBox;
class QFormLayout;

namespace lightloom {

/// A form built from `kParams`: one row for each parameter that a method reads, grouped by the stage it makes run
/// again, with tooltip, unit and range, while it is of use. What differs from the defaults is bold and has a button
/// that resets it.
class ParamPanel final : public QWidget {
    Q_OBJECT
public:
    explicit ParamPanel(Method method, QWidget* parent = nullptr);
    void setMethod(Method method); ///< rows of another; what was edited stays, the rest follows the preset
    [[nodiscard]] const BakeParams& params() const { return params_; }
    /// Shows other values; sends no signal.
    void setParams(const BakeParams& params);

Q_SIGNALS:
    /// The user set a value. The panel has checked its range.
    void edited(const lightloom::BakeParams& params);

private:
    struct Row {
        const ParamSpec* spec;
        QWidget* editor;
        QLabel* label;
        QToolButton* reset;
        QFormLayout* form;
    };
    void addRows();
    void addRow(const ParamSpec& spec, QFormLayout& form);
    QWidget* makeEditor(const ParamSpec& spec);
    void set(const ParamSpec& spec, double value);
    void showValues();

    BakeParams params_;
    Method method_;
    QWidget* form_ = nullptr; ///< holds the rows
    std::vector<Row> rows_;
    QComboBox* preset_;
    bool filling_ = false; ///< values are being shown, not edited
};

} // namespace lightloom
