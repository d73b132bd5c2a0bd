// SPDX-License-Identifier: GPL-3.0-or-later
// The catalogue of events against motions whose starts, ends, slips and meetings are known in
// closed form: rates exponential in time between steps, drawn on a small grid.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/catalogue.h"
#include "lacuna/simulation.h"
#include "support/test.h"

enum { MOST_CELLS = 64, MOST_EVENTS = 16 };

static const double rise = 1e-3;
static const double fall = 5e-4;
static const double slow = 1e-6;

// A film of rates, and the events that the catalogue made of it.
typedef struct film {
    lac_domain *domain;
    lac_catalogue catalogue;
    double v[MOST_CELLS], slip[MOST_CELLS]; // by cell of the domain
    double now;
    size_t count;
    lac_event event[MOST_EVENTS];
} film;

static lac_status keep(void *context, const lac_event *event, lac_error *err)
{
    (void)err;
    film *f = context;
    assert_true(f->count < MOST_EVENTS);
    f->event[f->count++] = *event;
    return LAC_OK;
}

static void show(film *f, double h)
{
    const lac_sink sink = {.context = f, .event = keep};
    lac_step step = {.time_origin = 100.0,
                     .time_local = f->now,
                     .step = h,
                     .n = f->domain->n,
                     .slip_rate = f->v,
                     .slip = f->slip};
    for (size_t i = 0; i < step.n; i++) {
        step.max_rate = fmax(step.max_rate, fabs(f->v[i]));
    }
    assert_int_equal(lac_catalogue_step(&f->catalogue, &step, &sink, NULL), LAC_OK);
}

static void film_open(film *f, size_t nx, size_t ny, bool periodic)
{
    const lac_grid grid = {nx, ny, 0.5, 2.0, periodic};
    double pressure[MOST_CELLS];
    memset(f, 0, sizeof *f);
    for (size_t i = 0; i < nx * ny; i++) {
        pressure[i] = 1.0;
        f->v[i] = slow;
    }
    assert_int_equal(lac_domain_create(&grid, pressure, &f->domain, NULL), LAC_OK);
    assert_int_equal(lac_catalogue_create(f->domain, rise, fall, 3e10, &f->catalogue, NULL),
                     LAC_OK);
    show(f, 0.0);
}

static size_t cell_at(const film *f, size_t x, size_t y)
{
    size_t i = 0;
    while (f->domain->index[i] != y * f->domain->grid.nx + x) {
        i++;
    }
    return i;
}

// One step of 1 s: the rates of the cells drawn go to 1 m/s where '+', slow where '-', between the
// limits where '~', and stay where '.'; all exponentially.
static void advance(film *f, const char *picture)
{
    for (size_t k = 0; picture[k] != '\0'; k++) {
        size_t i = cell_at(f, k % f->domain->grid.nx, k / f->domain->grid.nx);
        double was = f->v[i];
        double is = was;
        is = picture[k] == '+' ? 1.0 : is;
        is = picture[k] == '-' ? slow : is;
        is = picture[k] == '~' ? 0.7 * rise : is;
        f->slip[i] += is == was ? is : (is - was) / log(is / was);
        f->v[i] = is;
    }
    f->now += 1.0;
    show(f, 1.0);
}

static void film_close(film *f)
{
    const lac_sink sink = {.context = f, .event = keep};
    assert_int_equal(lac_catalogue_close(&f->catalogue, &sink, NULL), LAC_OK);
    assert_int_equal(f->catalogue.events, (int64_t)f->count);
    assert_int_equal(f->catalogue.actives, 0);
    for (size_t i = 0; i < f->domain->n; i++) {
        assert_int_equal(f->catalogue.event[i], UINT32_MAX);
    }
    lac_catalogue_clear(&f->catalogue);
    lac_domain_free(f->domain);
}

// Six decades up in one second: the crossings are at 1/2 and, down, log10(2e3)/6.
static void test_closed_form(void **state)
{
    (void)state;
    film f;
    film_open(&f, 1, 1, false);
    advance(&f, "+");
    advance(&f, ".");
    advance(&f, "-");
    assert_int_equal(f.count, 1);
    const lac_event *e = &f.event[0];
    const double down = log10(1.0 / fall) / 6.0;
    const double e_fold = 1.0 / log(1e6);
    const double slip = (1.0 - rise) * e_fold + 1.0 + (1.0 - fall) * e_fold;
    assert_true(fabs(e->time_origin + e->time_local - 100.5) < 1e-12);
    assert_true(fabs(e->duration - (1.5 + down)) < 1e-12);
    assert_true(fabs(e->potency - slip) < 1e-12 * slip); // 0.5 m by 2 m
    assert_true(fabs(e->moment - 3e10 * slip) < 1e-2);
    assert_true(e->cells == 1 && e->cut == 0);
    assert_true(e->size == 0.5 && e->x == 0.25 && e->y == 1.0); // a row: the width is no extent
    assert_true(e->max_rate == 1.0);
    film_close(&f);
    assert_int_equal(f.count, 1);
}

// Patches apart are two events at one time; the one that began later ends first.
static void test_two_at_once(void **state)
{
    (void)state;
    film f;
    film_open(&f, 6, 1, false);
    advance(&f, "++....");
    advance(&f, "....+.");
    advance(&f, "....-.");
    advance(&f, "--....");
    film_close(&f);
    assert_int_equal(f.count, 2);
    assert_true(f.event[0].cells == 1 && f.event[1].cells == 2);
    assert_true(f.event[0].time_local > f.event[1].time_local);
    assert_true(f.event[0].x == 2.25 && f.event[1].x == 0.25);
    assert_true(f.event[1].size == 1.0);
}

// A cell between two events makes them one, which began with the older; nothing is counted twice.
static void test_merging(void **state)
{
    (void)state;
    film f;
    film_open(&f, 7, 1, false);
    advance(&f, ".....++");
    advance(&f, "+......");
    advance(&f, "-......"); // ends apart
    advance(&f, "+......");
    advance(&f, ".+.....");
    advance(&f, "..++...");
    assert_int_equal(f.count, 1);
    advance(&f, "....+..");
    advance(&f, "-------");
    assert_int_equal(f.count, 2);
    double all = 0.0;
    for (size_t i = 0; i < 7; i++) {
        all += f.slip[i];
    }
    film_close(&f);
    assert_int_equal(f.count, 2);
    const lac_event *e = &f.event[1];
    assert_int_equal(e->cells, 7);
    assert_true(e->size == 3.5 && e->time_local == 0.5);
    assert_true(e->x == 2.75 || e->x == 3.25);
    assert_true(f.event[0].potency + e->potency < all);
    assert_true(f.event[0].potency + e->potency > 0.999 * all);
}

// The same cell in two events that become one is one cell.
static void test_same_cell_twice(void **state)
{
    (void)state;
    film f;
    film_open(&f, 5, 1, false);
    advance(&f, "++++.");
    advance(&f, ".---.");
    advance(&f, "..++."); // apart from the first, which goes on
    advance(&f, "...-.");
    advance(&f, ".+...");
    advance(&f, "-----");
    double all = 0.0;
    for (size_t i = 0; i < 5; i++) {
        all += f.slip[i];
    }
    film_close(&f);
    assert_true(f.event[0].potency > 0.999 * all && f.event[0].potency < all);
    assert_int_equal(f.count, 1);
    assert_int_equal(f.event[0].cells, 4);
    assert_true(f.event[0].size == 2.0);
}

// Between its limits a cell goes on as it did.
static void test_hold(void **state)
{
    (void)state;
    film f;
    film_open(&f, 2, 1, false);
    advance(&f, "+~");
    advance(&f, "~.");
    advance(&f, "+.");
    advance(&f, "--");
    film_close(&f);
    assert_int_equal(f.count, 1);
    assert_int_equal(f.event[0].cells, 1);
}

// Corners touch; so do opposite edges where the interface is periodic.
static void test_corners_and_edges(void **state)
{
    (void)state;
    const char *const up = "+..."
                           "...."
                           "...."
                           "...+";
    const char *const down = "----------------";
    film f;
    film_open(&f, 4, 4, true);
    advance(&f, up);
    advance(&f, down);
    film_close(&f);
    assert_int_equal(f.count, 1);
    assert_true(f.event[0].size == 4.0); // two rows of 2 m, round the edge
    film_open(&f, 4, 4, false);
    advance(&f, up);
    advance(&f, down);
    film_close(&f);
    assert_int_equal(f.count, 2);
}

// A jump of the loads starts or stops all at one time, without slip.
static void test_jump(void **state)
{
    (void)state;
    film f;
    film_open(&f, 2, 1, false);
    advance(&f, "..");
    f.v[0] = f.v[1] = -1.0; // backwards
    show(&f, 0.0);
    f.slip[0] -= 1.0;
    f.slip[1] -= 1.0;
    f.now += 1.0;
    show(&f, 1.0);
    f.v[0] = f.v[1] = 0.0;
    show(&f, 0.0);
    assert_int_equal(f.count, 1);
    assert_true(f.event[0].time_local == 1.0 && f.event[0].duration == 1.0);
    assert_true(f.event[0].cells == 2 && f.event[0].potency == 2.0);
    f.v[0] = 1.0; // from rest, within a step: at its end
    f.now += 1.0;
    show(&f, 1.0);
    film_close(&f);
    assert_true(f.event[1].time_local == 3.0 && f.event[1].cut == LAC_EVENT_UNENDED);
}

static void test_cut_by_the_run(void **state)
{
    (void)state;
    film f;
    film_open(&f, 3, 1, false);
    lac_catalogue_clear(&f.catalogue);
    assert_int_equal(lac_catalogue_create(f.domain, rise, fall, NAN, &f.catalogue, NULL), LAC_OK);
    f.v[0] = 1.0;
    show(&f, 0.0);
    advance(&f, "..+");
    advance(&f, "-..");
    film_close(&f);
    assert_int_equal(f.count, 2);
    assert_int_equal(f.event[0].cut, LAC_EVENT_BEGUN_BEFORE);
    assert_int_equal(f.event[1].cut, LAC_EVENT_UNENDED);
    assert_true(f.event[1].duration == 1.5 && isnan(f.event[1].moment));
    // one event of two, one of which began before
    film_open(&f, 3, 1, false);
    lac_catalogue_clear(&f.catalogue);
    assert_int_equal(lac_catalogue_create(f.domain, rise, fall, NAN, &f.catalogue, NULL), LAC_OK);
    f.v[0] = 1.0;
    show(&f, 0.0);
    advance(&f, "..+");
    advance(&f, ".+.");
    film_close(&f);
    assert_int_equal(f.count, 1);
    assert_int_equal(f.event[0].cut, LAC_EVENT_BEGUN_BEFORE | LAC_EVENT_UNENDED);
    assert_true(f.event[0].time_local == 0.0 && f.event[0].cells == 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_form),       cmocka_unit_test(test_two_at_once),
        cmocka_unit_test(test_merging),           cmocka_unit_test(test_same_cell_twice),
        cmocka_unit_test(test_corners_and_edges), cmocka_unit_test(test_jump),
        cmocka_unit_test(test_cut_by_the_run),    cmocka_unit_test(test_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
