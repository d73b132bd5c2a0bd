// SPDX-License-Identifier: GPL-3.0-or-later
// A catalogue of events that goes through a checkpoint after any of its steps ends up with the
// same events, to the last bit; a archive that is cut or wrong does no harm.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/catalogue.h"
#include "lacuna/simulation.h"
#include "support/test.h"

enum { NX = 6, NY = 5, CELLS = NX * NY, STEPS = 61, MOST_EVENTS = 400 };

// The events that were put out.
typedef struct listing {
    size_t count;
    lac_event event[MOST_EVENTS];
} listing;

static lac_domain *domain;

static int make_domain(void **state)
{
    (void)state;
    const lac_grid grid = {NX, NY, 0.5, 2.0, true};
    double pressure[CELLS];
    for (size_t i = 0; i < CELLS; i++) {
        pressure[i] = i % 7 == 3 ? 0.0 : 1.0;
    }
    return lac_domain_create(&grid, pressure, &domain, NULL) == LAC_OK ? 0 : -1;
}

static int free_domain(void **state)
{
    (void)state;
    lac_domain_free(domain);
    return 0;
}

static lac_status put(void *context, const lac_event *event, lac_error *err)
{
    (void)err;
    listing *all = context;
    assert_true(all->count < MOST_EVENTS);
    all->event[all->count++] = *event;
    return LAC_OK;
}

static void open_catalogue(lac_catalogue *c)
{
    assert_int_equal(lac_catalogue_create(domain, 1e-3, 4e-4, 3e10, c, NULL), LAC_OK);
}

// Rates about the limits, different at each step and cell, and their slip.
static void draw(size_t k, double *v, double *slip)
{
    for (size_t i = 0; i < domain->n; i++) {
        v[i] = 0.0;
        slip[i] = 0.0;
        for (size_t j = 0; j <= k; j++) {
            double x = sin(12.9898 * (double)(i + 1) + 78.233 * (double)(j + 1)) * 43758.5453;
            v[i] = 1e-3 * pow(10.0, 2.0 * (x - floor(x)) - 1.8);
            slip[i] += v[i];
        }
    }
}

static void look(lac_catalogue *c, size_t k, listing *all)
{
    double v[CELLS], slip[CELLS];
    const lac_sink sink = {.context = all, .event = put};
    draw(k, v, slip);
    lac_step step = {.time_origin = k < 20 ? 0.0 : 1e9,
                     .time_local = (double)k,
                     .step = k == 0 || k == 25 ? 0.0 : 1.0,
                     .n = domain->n,
                     .slip_rate = v,
                     .slip = slip};
    for (size_t i = 0; i < step.n; i++) {
        step.max_rate = fmax(step.max_rate, v[i]);
    }
    assert_int_equal(lac_catalogue_step(c, &step, &sink, NULL), LAC_OK);
}

static void end(lac_catalogue *c, listing *all)
{
    const lac_sink sink = {.context = all, .event = put};
    assert_int_equal(lac_catalogue_close(c, &sink, NULL), LAC_OK);
}

static lac_archive save(lac_catalogue *c)
{
    lac_archive archive = {.loading = false};
    lac_catalogue_serialize(c, &archive);
    assert_true(lac_archive_good(&archive));
    return archive;
}

// A new catalogue from a archive; whether the archive was good and read to its end.
static bool load(lac_catalogue *c, unsigned char *bytes, size_t size)
{
    lac_archive archive = {.loading = true, .bytes = bytes, .size = size};
    open_catalogue(c);
    lac_catalogue_serialize(c, &archive);
    return lac_archive_good(&archive) && archive.at == archive.size;
}

static void check_same(const lac_event *a, const lac_event *b)
{
    const double left[] = {a->time_origin, a->time_local, a->duration, a->potency, a->moment,
                           a->size,        a->x,          a->y,        a->max_rate};
    const double right[] = {b->time_origin, b->time_local, b->duration, b->potency, b->moment,
                            b->size,        b->x,          b->y,        b->max_rate};
    assert_memory_equal(left, right, sizeof left);
    assert_int_equal(a->cells, b->cells);
    assert_int_equal(a->cut, b->cut);
}

static void check_counts(const lac_catalogue *a, const lac_catalogue *b)
{
    const double left[] = {a->largest_slip, a->largest_size, a->slip_sum};
    const double right[] = {b->largest_slip, b->largest_size, b->slip_sum};
    assert_memory_equal(left, right, sizeof left);
    assert_int_equal(a->events, b->events);
    assert_int_equal(a->cut, b->cut);
}

static void test_goes_on_from_any_step(void **state)
{
    (void)state;
    static listing whole, part;
    lac_catalogue a, b;
    whole.count = 0;
    open_catalogue(&a);
    for (size_t k = 0; k < STEPS; k++) {
        look(&a, k, &whole);
    }
    assert_true(a.actives > 0); // to be cut by the end
    end(&a, &whole);
    assert_true(whole.count > 20);
    for (size_t stop = 0; stop <= STEPS; stop++) {
        part.count = 0;
        open_catalogue(&b);
        for (size_t k = 0; k < stop; k++) {
            look(&b, k, &part);
        }
        lac_archive archive = save(&b);
        end(&b, &(listing){.count = 0}); // what a stopped run does
        lac_catalogue_clear(&b);
        assert_true(load(&b, archive.bytes, archive.size));
        free(archive.bytes);
        for (size_t k = stop; k < STEPS; k++) {
            look(&b, k, &part);
        }
        end(&b, &part);
        assert_int_equal(part.count, whole.count);
        for (size_t i = 0; i < whole.count; i++) {
            check_same(&part.event[i], &whole.event[i]);
        }
        check_counts(&a, &b);
        lac_catalogue_clear(&b);
    }
    lac_catalogue_clear(&a);
}

// Cut anywhere it is refused; with a byte that is wrong it is refused, or can be gone on from. What
// is refused is summed up without an event.
static void test_bad_tapes(void **state)
{
    (void)state;
    static listing all;
    lac_catalogue c;
    all.count = 0;
    open_catalogue(&c);
    for (size_t k = 0; k < 30; k++) {
        look(&c, k, &all);
    }
    assert_true(c.actives > 0 && c.actives < domain->n);
    lac_archive archive = save(&c);
    lac_catalogue_clear(&c);
    for (size_t size = 0; size < archive.size; size++) {
        assert_false(load(&c, archive.bytes, size));
        all.count = 0;
        end(&c, &all);
        assert_int_equal(all.count, 0);
        lac_catalogue_clear(&c);
    }
    size_t refused = 0;
    for (size_t at = 0; at < archive.size; at += 3) {
        archive.bytes[at] ^= 0x55;
        const bool good = load(&c, archive.bytes, archive.size);
        all.count = 0;
        if (good) {
            look(&c, 30, &all);
        }
        end(&c, &all);
        assert_true(good || all.count == 0);
        refused += good ? 0 : 1;
        archive.bytes[at] ^= 0x55;
        lac_catalogue_clear(&c);
    }
    assert_true(refused > 10);
    free(archive.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_goes_on_from_any_step),
        cmocka_unit_test(test_bad_tapes),
    };
    return cmocka_run_group_tests_name("catalogue_keep", tests, make_domain, free_domain);
}
