// SPDX-License-Identifier: GPL-3.0-or-later
// output.points: reading places by name, and what is wrong with them.
#include <ctype.h>

#include "base/hidden.h"
#include "case/sections.h"

enum { MOST_POINTS = 1000, LONGEST_NAME = 60 };

// A name is a word of a legend and of a table: nothing in it is hidden, or blank at its ends.
static bool is_name(const char *name)
{
    const size_t n = strlen(name);
    for (size_t i = 0; i < n; i++) {
        if (iscntrl((unsigned char)name[i]) || lac_hidden_length(name + i, n - i) > 0) {
            return false;
        }
    }
    return n > 0 && n <= LONGEST_NAME && name[0] != ' ' && name[n - 1] != ' ';
}

static void read_point(lac_reader *reader, const lac_node *node, const lac_point_def *before,
                       lac_point_def *def)
{
    const lac_section *table = lac_section_find("output.points");
    lac_table_reset(table, def);
    if (!lac_expect_map(reader, node, "a mapping such as {name: P1, x: 12 m, y: 3 m}")) {
        return;
    }
    lac_read_table(reader, node, table, NULL, def);
    if (def->name == NULL) {
        return; // reported
    }
    const lac_node *name = lac_node_child(node, "name");
    if (!is_name(def->name)) {
        lac_add_error(reader, name, "must be a name of 1 to %d bytes that can be seen",
                      LONGEST_NAME);
    }
    for (const lac_point_def *other = before; other < def; other++) {
        if (other->name != NULL && strcmp(other->name, def->name) == 0) {
            lac_add_error(reader, name, "is the name of a point above, too");
            return;
        }
    }
}

void lac_read_points(lac_reader *reader, const lac_node *node, lac_case *c)
{
    if (node->kind != LAC_NODE_LIST) {
        lac_add_error(reader, node, "must be a list such as [{name: P1, x: 12 m, y: 3 m}, ...]");
        return;
    }
    if (node->count > MOST_POINTS) {
        lac_add_error(reader, node, "has %zu points; at most %d are allowed", node->count,
                      MOST_POINTS);
        return;
    }
    c->point = lac_reader_array(reader, node->count, sizeof *c->point);
    c->points = c->point != NULL ? node->count : 0;
    for (size_t i = 0; i < c->points; i++) {
        read_point(reader, node->child[i], c->point, &c->point[i]);
    }
}

size_t lac_case_point(const lac_case *c, const char *name)
{
    size_t i = 0;
    while (i < c->points && strcmp(c->point[i].name, name) != 0) {
        i++;
    }
    return i;
}

// A place along an axis. @param has  the joint reaches along it; else a value has no meaning
static void check_place(lac_reader *reader, const lac_node *node, const char *axis, double at,
                        double length)
{
    const lac_node *given = lac_node_child(node, axis);
    char text[64];
    if (given != NULL && (at < 0.0 || at > length)) {
        lac_add_error(reader, given, "lies outside of the joint, which reaches from 0 to %s",
                      lac_units_format(length, "m", text, sizeof text));
    }
}

void lac_check_points(lac_reader *reader, const lac_case *c)
{
    const lac_node *list = lac_node_at(reader->root, "output.points");
    if (c->points == 0 || !lac_clean(reader, "output.points") || !lac_clean(reader, "interface")) {
        return;
    }
    const lac_grid grid = lac_interface_grid(&c->interface);
    const bool block = lac_grid_cells(&grid) == 1, line = c->interface.shape == LAC_LINE;
    // A block whose size nobody gave has no places; there x and y say nothing.
    const bool sized = !block || HAS("interface.size");
    for (size_t i = 0; i < c->points; i++) {
        const lac_node *node = list->child[i];
        const lac_point_def *p = &c->point[i];
        if (line && !isnan(p->y)) {
            lac_add_error(reader, lac_node_child(node, "y"), "has no place on a line: x alone");
        } else if (!block && (isnan(p->x) || (isnan(p->y) && !line))) {
            lac_add_error(reader, node, line ? "needs x" : "needs x and y");
        } else if (sized) {
            check_place(reader, node, "x", p->x, (double)grid.nx * grid.dx);
            check_place(reader, node, "y", p->y, (double)grid.ny * grid.dy);
        }
    }
}

static void check_named(lac_reader *reader, const lac_case *c, const char *key, const char *point)
{
    const bool known = point == NULL || lac_case_point(c, point) < c->points;
    (void)lac_refuse(reader, !known, key, "is none of the names in output.points");
}

void lac_check_point_names(lac_reader *reader, const lac_case *c)
{
    if (!lac_clean(reader, "output.points")) {
        return;
    }
    check_named(reader, c, "fit.point", c->fit.point);
    for (size_t i = 0; i < c->compare_count; i++) {
        char key[LAC_KEY_LENGTH];
        (void)snprintf(key, sizeof key, "compare.%zu.point", i);
        check_named(reader, c, key, c->compare[i].point);
    }
}
