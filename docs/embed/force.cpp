// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the critical force of a joint, of each beta that its case names: docs/howto-embed.md.
#include <lacuna/lacuna.h>

#include <cstdio>
#include <memory>
#include <vector>

static std::vector<double> values(const lac_dataset *dataset, const char *name)
{
    std::vector<double> all(lac_dataset_count(dataset, name));
    lac_error err = {""};
    if (lac_dataset_values(dataset, name, all.size(), all.data(), &err) != LAC_OK) {
        std::fprintf(stderr, "force: %s\n", err.message);
    }
    return all;
}

int main(int argc, char **argv)
{
    lac_error err = {""};
    lac_case *read = nullptr;
    lac_dataset *made = nullptr;
    lac_case_options options = lac_case_options_default();
    options.purpose = LAC_FOR_RG;
    lac_status status = lac_case_load(argc > 1 ? argv[1] : "case.yaml", &options, &read, &err);
    const std::unique_ptr<lac_case, decltype(&lac_case_free)> c(read, lac_case_free);
    status = status == LAC_OK ? lac_rg_compute(c.get(), nullptr, &made, &err) : status;
    const std::unique_ptr<lac_dataset, decltype(&lac_dataset_free)> rg(made, lac_dataset_free);
    if (status != LAC_OK) {
        std::fprintf(stderr, "force: %s\n", err.message);
        return status;
    }
    const char *const name = "q_crit_over_q_nom";
    std::printf("%s:", lac_dataset_long_name(rg.get(), name));
    for (const double force : values(rg.get(), name)) {
        std::printf(" %.4f", force);
    }
    std::printf("\n");
    return 0;
}
