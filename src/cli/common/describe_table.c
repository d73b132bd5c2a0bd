// SPDX-License-Identifier: GPL-3.0-or-later
// Models, sections and their parameters as a dataset: lacuna describe --pipe.
#include "cli/common/describe.h"
#include "cli/common/output.h"
#include "data/describe.h"

bool cli_param_is_number(const lac_param *param)
{
    return param->type == LAC_REAL || param->type == LAC_INTEGER;
}

// Ranges beyond what anything measures mean "no limit".
bool cli_param_is_bounded(const lac_param *param, double limit)
{
    return cli_param_is_number(param) && fabs(limit) < DBL_MAX / 2;
}

const char *cli_param_type(const lac_param *param)
{
    static const char *const names[] = {
        [LAC_REAL] = "real", [LAC_INTEGER] = "integer", [LAC_CHOICE] = "choice",
        [LAC_TEXT] = "text", [LAC_PATH] = "path",
    };
    return names[param->type];
}

#define PARAMETER const cli_described_param *p = of
#define NUMBER(which) cli_param_is_number(&p->param) ? p->param.which : (double)NAN
#define BOUND(which) cli_param_is_bounded(&p->param, p->param.which) ? p->param.which : (double)NAN

static const char *choices_text(const lac_param *param, char room[LAC_TEXT_ROOM])
{
    room[0] = '\0';
    for (size_t i = 0; param->type == LAC_CHOICE && param->choices[i] != NULL; i++) {
        lac_append(room, LAC_TEXT_ROOM, "%s%s", i > 0 ? " " : "", param->choices[i]);
    }
    return room;
}

LAC_TEXT_GETTER(key, PARAMETER, p->param.key)
LAC_TEXT_GETTER(type, PARAMETER, cli_param_type(&p->param))
LAC_TEXT_GETTER(unit, PARAMETER, cli_param_is_number(&p->param) ? p->param.unit : "")
LAC_GETTER(double, required, PARAMETER, lac_param_required(&p->param))
LAC_GETTER(double, fallback, PARAMETER, NUMBER(fallback))
LAC_TEXT_GETTER(choice, PARAMETER,
                p->param.type == LAC_CHOICE && !isnan(p->param.fallback)
                    ? p->param.choices[(int)p->param.fallback]
                    : "")
LAC_TEXT_GETTER(choices, PARAMETER, choices_text(&p->param, room))
LAC_GETTER(double, least, PARAMETER, BOUND(min))
LAC_GETTER(double, most, PARAMETER, BOUND(max))
LAC_GETTER(double, above_min, PARAMETER, (p->param.flags & LAC_ABOVE_MIN) != 0)
LAC_GETTER(double, cellwise, PARAMETER, (p->param.flags & LAC_CELLWISE) != 0)
LAC_TEXT_GETTER(doc, PARAMETER, p->param.doc)

static const lac_variable of_params[] = {
    LAC_ROW("kind", NULL, NULL, "kind of the model, section of plain parameters",
            LAC_HELD(TEXT, cli_described_param, kind)),
    LAC_ROW("of_model", NULL, NULL, "model or section that the parameter is of",
            LAC_HELD(TEXT, cli_described_param, model)),
    LAC_ROW("key", NULL, NULL, "its key in a case", T(key)),
    LAC_ROW("type", NULL, NULL, "real, integer, choice, text, path", T(type)),
    LAC_ROW("unit", NULL, NULL, "SI unit", T(unit)),
    LAC_ROW("required", NULL, NULL, "1: must be given", G(required), .flags = LAC_WHOLE),
    LAC_ROW("default", NULL, NULL, "default, in SI", G(fallback), .flags = LAC_MISSING),
    LAC_ROW("default_choice", NULL, NULL, "default of a choice", T(choice)),
    LAC_ROW("choices", NULL, NULL, "what can be chosen", T(choices)),
    LAC_ROW("min", NULL, NULL, "least value, in SI", G(least), .flags = LAC_MISSING),
    LAC_ROW("max", NULL, NULL, "largest value, in SI", G(most), .flags = LAC_MISSING),
    LAC_ROW("above_min", NULL, NULL, "1: the least itself is excluded", G(above_min),
            .flags = LAC_WHOLE),
    LAC_ROW("cellwise", NULL, NULL, "1: may vary from cell to cell", G(cellwise),
            .flags = LAC_WHOLE),
    LAC_ROW("doc", NULL, NULL, "what it is", T(doc)),
};

#define MODEL const cli_described_model *m = of
LAC_TEXT_GETTER(name, MODEL, m->info->name)
LAC_TEXT_GETTER(summary, MODEL, m->info->summary)
LAC_TEXT_GETTER(reference, MODEL, m->info->reference)

static const lac_variable of_models[] = {
    LAC_ROW("model_name", NULL, NULL, "model, section of plain parameters", T(name)),
    LAC_ROW("model_kind", NULL, NULL, "its kind; of a section its name",
            LAC_HELD(TEXT, cli_described_model, kind)),
    LAC_ROW("model_section", NULL, NULL, "where it stands in a case",
            LAC_HELD(TEXT, cli_described_model, section)),
    LAC_ROW("model_summary", NULL, NULL, "what it is", T(summary)),
    LAC_ROW("model_reference", NULL, NULL, "what to cite", T(reference)),
};

lac_status cli_described_add(cli_described *table, const char *kind, const char *section,
                             const lac_model_info *info, lac_error *err)
{
    const size_t params = table->params + info->param_count + 1;
    LAC_TRY_RETURN(lac_grow((void *)&table->model, &table->model_room, table->models + 1,
                            sizeof *table->model, err));
    LAC_TRY_RETURN(
        lac_grow((void *)&table->param, &table->param_room, params, sizeof *table->param, err));
    table->model[table->models++] = (cli_described_model){kind, section, info};
    for (size_t i = 0; i < info->param_count; i++) {
        table->param[table->params++] = (cli_described_param){kind, info->name, info->params[i]};
    }
    return LAC_OK;
}

lac_status cli_described_put(const cli_request *request, const cli_described *table, lac_error *err)
{
    const lac_extent dims[] = {{"model", table->models}, {"parameter", table->params}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_models, "model", sizeof *table->model), table->model},
        {LAC_VARIABLES(of_params, "parameter", sizeof *table->param), table->param}};
    const lac_provenance made = {.seed = INT64_MIN};
    lac_dataset *dataset = NULL;
    lac_status status;
    LAC_TRY(
        lac_dataset_create("Models and sections of a case with their parameters.", &dataset, err));
    LAC_TRY(lac_dataset_dims(dataset, dims, 2, err));
    LAC_TRY(lac_dataset_add(dataset, laid, 2, err));
    LAC_TRY(cli_put_dataset(request, false, &made, NULL, dataset, err));
out:
    lac_dataset_free(dataset);
    return status;
}
