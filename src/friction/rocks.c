// SPDX-License-Identifier: GPL-3.0-or-later
// Rocks and gouges whose friction somebody measured, or found by analysing a slope that failed: one
// table, a row each. A number stands here only where it was read in the source that the row names.
#include "friction/law.h"

#define BARTON                                                                      \
    "Barton & Choubey (1977) Rock Mechanics 10, 1, as table 2.5 of \"Mechanics of " \
    "Asphalt: Microstructure and Micromechanics\", p. 48, gives it: basic friction angles"
#define BARTON_AT                                                                   \
    "https://digilib.universitaspertamina.ac.id/ebook/Mechanics%20of%20Asphalt%20:" \
    "%20Microstructure%20and%20Micromechanics/files/basic-html/page55.html"
#define CAFARO                                                                                     \
    "Cafaro and others (2022), doi 10.2478/sgem-2022-0014: strength of rock fractures, with data " \
    "of Barton (1973) and Alejano and others (2012)"
#define CAFARO_AT "https://sciendo.com/de/article/10.2478/sgem-2022-0014?tab=figures-and-tables"
#define TRB                                                                       \
    "Typical range of friction angles of rock joints (TRB, 1990), table 9.15 of " \
    "\"Geotechnical Investigation and Design Tables\""
#define TRB_AT                                                                               \
    "http://what-when-how.com/Tutorial/topic-topic-8958bvhr/Geotechnical-Investigation-and-" \
    "Design-Tables-134.html"
#define GIACOMEL_AT "https://github.com/pgiacomel/steadystate"
#define ANGLES(dry_, wet_) "plane joint, no roughness; " dry_ " dry, " wet_ " wet"

// A value and its range; a number without one; of an angle [degree].
#define IS(value, low, high) \
    {                        \
        value, low, high     \
    }
#define ONE(value)          \
    {                       \
        value, value, value \
    }

// name, what it is, source, where it was read, conditions, and what it states. The value is that of
// the middle of what is stated (of wet joints), unless the conditions say another.
// clang-format off
#define ROCKS(_)                                                                                  \
    _("amphibolite", "joint", BARTON, BARTON_AT,                                                  \
      "plane joint, no roughness; 32 degree dry, wet not stated",                                 \
      .degrees = true, F0 = ONE(32))                                                              \
    _("anorthite-gouge", "crushed anorthite (feldspar), grains of 1 um",                          \
      "Masuda (2020) Earth, Planets and Space, doi 10.1186/s40623-020-01271-6, table 1",          \
      "https://earth-planets-space.springeropen.com/articles/10.1186/s40623-020-01271-6/tables/1", \
      "dry under 150 MPa, wet under 200 MPa with 50 MPa of pore water, 20-600 degC; the value is " \
      "that of 20 degC, dry",                                                                     \
      F0 = IS(0.697, 0.6415, 0.7483), AB = IS(0.00092, -0.01587, 0.00299))                        \
    _("basalt", "joint", BARTON, BARTON_AT, ANGLES("35-38 degree", "31-36"),                      \
      .degrees = true, F0 = IS(33.5, 31, 38))                                                     \
    _("basalt-fault", "fault in basalt",                                                          \
      "fitted here by tools/studies/velocity_step.py to step 4 of experiment b819 in the data of " \
      "Giacomel, Faulkner, Lambert & Allen (2024) Geosphere 20, 965, doi 10.1130/GES02739.1",     \
      GIACOMEL_AT,                                                                                \
      "20 MPa, room temperature, 3 to 10 um/s; the values are those of the aging law, the ranges " \
      "hold those of the slip law and a standard error",                                          \
      F0 = IS(0.608, 0.607, 0.609), A = IS(0.00913, 0.009, 0.0096),                               \
      B = IS(0.00907, 0.0089, 0.0096), DC = IS(6.2e-6, 6.1e-6, 8.5e-6))                           \
    _("brucite-gouge", "crushed brucite",                                                         \
      "Moore, Lockner, Iwata, Tanaka & Byerlee (2001) USGS Open-File Report 01-320, doi "         \
      "10.3133/ofr01320, abstract",                                                               \
      "https://pubs.usgs.gov/publication/ofr01320?mimetype=dublincore",                           \
      "hydrothermal, to 450 degC; the value is that of room temperature, the least that near 300 " \
      "degC",                                                                                     \
      F0 = IS(0.3, 0.2, 0.3))                                                                     \
    _("chlorite-schist-gouge", "crushed chlorite schist, grains below 125 um",                    \
      "Fagereng & Ikari (2020), doi 10.1029/2020JB019487, abstract",                              \
      "https://scribd.com/document/676470298/2020-Fagereng-Ikari-Low-Temperature-Frictional-"     \
      "Characteristics-of-Chlorite-Epidote-Amphibole-Assemblages-Implications-for-Strength-and",  \
      "10 MPa, room temperature, saturated; strengthens with rate",                               \
      F0 = ONE(0.36))                                                                             \
    _("clay-gouge", "natural gouge of the Panamint Valley fault, more than half of it clay",      \
      "Numelin, Marone & Kirby (2005), manuscript submitted to Tectonics, abstract",              \
      "https://vdocuments.site/frictional-properties-of-natural-fault-gouge-cjm38paperstalks-"    \
      "planes-wernicke.html",                                                                     \
      "5-150 MPa, room temperature and humidity",                                                 \
      F0 = IS(0.3, 0.2, 0.4))                                                                     \
    _("coal-gouge", "crushed bituminous coal",                                                    \
      "Fan, Liu, Hunfeld & Spiers (2020) Solid Earth 11, 1399, doi 10.5194/se-11-1399-2020, "     \
      "abstract",                                                                                 \
      "https://se.copernicus.org/articles/11/1399/2020",                                          \
      "25-45 MPa effective, 100 degC, dry or 15 MPa of pore water, 0.1-100 um/s; the value is "   \
      "nearly steady, the most a peak within 1-2 mm of slip",                                     \
      F0 = IS(0.3, 0.3, 0.5))                                                                     \
    _("dolerite", "joint", BARTON, BARTON_AT, ANGLES("36 degree", "32"),                          \
      .degrees = true, F0 = IS(32, 32, 36))                                                       \
    _("gabbro", "sand-blasted or lapped faces of gabbro, 14 cm x 40 cm",                          \
      "Marone and others (1994) Pure and Applied Geophysics 143, 359, abstract",                  \
      "https://waesearch.kobv.de/advancedSearch.do?f1=author&v1=Marone%2C+Chris",                 \
      "5 MPa, room temperature, 0.1-10 um/s; the values are those of rough faces after 50 mm of " \
      "slip (first 0.45 and 1 um), where they have come to weaken with rate",                     \
      F0 = IS(0.7, 0.45, 0.7), DC = IS(4e-6, 1e-6, 4e-6))                                         \
    _("gneiss", "joint", BARTON, BARTON_AT, ANGLES("26-29 degree", "23-26"),                      \
      .degrees = true, F0 = IS(24.5, 23, 29))                                                     \
    _("granite", "joint, fine or coarse grains", BARTON, BARTON_AT,                               \
      ANGLES("31-35 degree", "29-33"),                                                            \
      .degrees = true, F0 = IS(31, 29, 35))                                                       \
    _("granite-gouge", "crushed granite",                                                         \
      "Blanpied, Lockner & Byerlee (1995) J. Geophys. Res. 100, 13045, doi 10.1029/95JB00862, "   \
      "abstract",                                                                                 \
      "https://www.usgs.gov/node/142788",                                                         \
      "dry to 845 degC and wet below 250 degC",                                                   \
      F0 = IS(0.75, 0.7, 0.8))                                                                    \
    _("illite-gouge", "94 % illite, 6 % quartz",                                                  \
      "\"The roles of quartz and water in controlling unstable slip in phyllosilicate-rich "      \
      "megathrust fault gouges\", Earth, Planets and Space 66:78, doi 10.1186/1880-5981-66-78, "  \
      "table 1, RSI1 to RSI3",                                                                    \
      "https://earth-planets-space.springeropen.com/articles/10.1186/1880-5981-66-78/tables/1",   \
      "170 MPa effective, 100 MPa of pore water, 1-100 um/s; the value is that of 200 degC, the " \
      "most that of 500 degC",                                                                    \
      F0 = IS(0.53, 0.53, 0.74))                                                                  \
    _("limestone", "joint", BARTON, BARTON_AT, ANGLES("31-37 degree", "27-35"),                   \
      .degrees = true, F0 = IS(31, 27, 37))                                                       \
    _("marble", "joint", CAFARO, CAFARO_AT, ANGLES("49 degree", "42"),                            \
      .degrees = true, F0 = IS(42, 42, 49))                                                       \
    _("mica-gouge", "natural gouge with chlorite and white mica, Alpine Fault, DFDP-1A",          \
      "Boulton, Moore, Lockner, Toy, Townend & Sutherland (2014) Geophys. Res. Lett., doi "       \
      "10.1002/2013GL058236, abstract",                                                           \
      "https://zendy.io/title/10.1002/2013gl058236",                                              \
      "31-156 MPa effective, 70-350 degC, 0.01-3 um/s; strengthens with rate below 210 degC",     \
      F0 = IS(0.685, 0.61, 0.76))                                                                 \
    _("montmorillonite-gouge", "montmorillonite (smectite), saturated",                           \
      "Morrow, Moore & Lockner (2017), doi 10.1002/2016JB013658, abstract",                       \
      "https://pubs.usgs.gov/publication/70188416?mimetype=dublincore",                           \
      "to 700 MPa; the value is that of the least effective stress, the most that of the "        \
      "greatest; strengthens with rate; dry 0.45-0.78",                                           \
      F0 = IS(0.1, 0.1, 0.28))                                                                    \
    _("mudstone", "joint", CAFARO, CAFARO_AT, ANGLES("32 degree", "29"),                          \
      .degrees = true, F0 = IS(29, 29, 32))                                                       \
    _("sandstone", "joint", BARTON, BARTON_AT, ANGLES("26-35 degree", "25-34"),                   \
      .degrees = true, F0 = IS(29.5, 25, 35))                                                     \
    _("sandstone-gouge", "arkosic sandstone, siltstone and granodiorite of the SAFOD borehole",   \
      "Carpenter, Marone & Saffer (2009) Geophys. Res. Lett., L05302, abstract",                  \
      "https://pure.psu.edu/en/publications/frictional-behavior-of-materials-in-the-3d-safod-"    \
      "volume",                                                                                   \
      "not stated in the abstract",                                                                 \
      F0 = IS(0.61, 0.56, 0.66))                                                                  \
    _("schist", "joint (with shale the class of low friction)", TRB, TRB_AT,                      \
      "without infill, no roughness; 20-27 degree",                                               \
      .degrees = true, F0 = IS(23.5, 20, 27))                                                     \
    _("sepiolite-gouge", "sepiolite (a clay)",                                                    \
      "measured here by tools/studies/velocity_step.py on step 3 of experiment TR2-013 in the "   \
      "data of Giacomel, Faulkner, Lambert & Allen (2024) Geosphere 20, 965, doi "                \
      "10.1130/GES02739.1",                                                                       \
      GIACOMEL_AT,                                                                                \
      "30 MPa; 0.455 at 0.2 um/s, 0.500 to 0.502 over 0.25-2 mm of slip at 2 um/s; the value is " \
      "that of 1 um/s",                                                                           \
      F0 = IS(0.487, 0.455, 0.502), AB = IS(0.0202, 0.0197, 0.0208))                                \
    _("serpentinite-gouge", "natural serpentinite beside the San Andreas fault",                  \
      "Carpenter, Marone & Saffer (2009) Geophys. Res. Lett., L05302, abstract",                  \
      "https://pure.psu.edu/en/publications/frictional-behavior-of-materials-in-the-3d-safod-"    \
      "volume",                                                                                   \
      "not stated in the abstract",                                                                 \
      F0 = IS(0.22, 0.18, 0.26))                                                                  \
    _("shale", "joint", CAFARO, CAFARO_AT, ANGLES("29 degree", "21"),                             \
      .degrees = true, F0 = IS(21, 21, 29))                                                       \
    _("siltstone", "joint", CAFARO, CAFARO_AT, ANGLES("32 degree", "30"),                         \
      .degrees = true, F0 = IS(30, 30, 32))                                                       \
    _("slate", "joint (with sandstone, siltstone, chalk and gneiss the class of medium friction)", \
      TRB, TRB_AT, "without infill, no roughness; 27-34 degree",                                  \
      .degrees = true, F0 = IS(30.5, 27, 34))                                                     \
    _("talc-gouge", "crushed talc, saturated",                                                    \
      "Chen, Elwood Madden & Reches (2017) J. Geophys. Res. Solid Earth 122, 3661, doi "          \
      "10.1002/2016JB013676, abstract",                                                           \
      "https://zendy.io/title/10.1002/2016jb013676",                                              \
      "to 4.1 MPa, 0.002-0.66 m/s",                                                               \
      F0 = IS(0.2, 0.1, 0.3), AB = IS(0.025, 0.01, 0.04))                                         \
    _("vajont", "slip surface of the Vajont slide of 1963",       \
      "Boon, Houlsby & Utili (2014), \"New insights in the 1963 Vajont slide using 2D and 3D Distinct "  \
      "Element Method analyses\", abstract",                                                      \
      "https://studylib.net/doc/12918082",                                                        \
      "friction reduced in a model of the slope until it slides: signs of failure from 26 "       \
      "degree, no resistance left at 18 degree, which is the value",                              \
      .degrees = true, .in_field = true, F0 = IS(18, 18, 26))

#define F0 .stated[LAC_ROCK_F0]
#define A  .stated[LAC_ROCK_A]
#define B  .stated[LAC_ROCK_B]
#define DC .stated[LAC_ROCK_DC]
#define AB .stated[LAC_ROCK_A_B]
#define NAME(called, ...) called,
#define ROW(called, text, from, place, how, ...)                                                  \
    {.name = (called), .summary = (text), .source = (from), .read_at = (place),                   \
     .conditions = (how), __VA_ARGS__},
// clang-format on

const char *const lac_rock_names[] = {ROCKS(NAME) NULL};

static const lac_rock rocks[] = {ROCKS(ROW)};

LAC_ROWS_AT(lac_rock, lac_rock_get, rocks)

const lac_rock_quantity lac_rock_quantities[LAC_ROCK_VALUES] = {
    {"f0", "1"}, {"a", "1"}, {"b", "1"}, {"dc", "m"}, {"a_minus_b", "1"}};

static double tangent(double degrees) { return tan(degrees * (acos(-1.0) / 180)); }

lac_rock_value lac_rock_value_of(const lac_rock *rock, int which)
{
    const lac_rock_value told = rock->stated[which];
    if (told.value == 0 && told.low == 0 && told.high == 0) {
        return (lac_rock_value){NAN, NAN, NAN};
    }
    return which == LAC_ROCK_F0 && rock->degrees
               ? (lac_rock_value){tangent(told.value), tangent(told.low), tangent(told.high)}
               : told;
}

// Where a law's table has what a case may say in the place of f0, a, b and dc.
static bool is_told(uint64_t given, int row) { return (given >> row & 1) != 0; }

// Of a and b the other one, where a rock tells their difference and a case one of them.
static const char *complete_pair(double a_minus_b, uint64_t given, lac_friction_params *p)
{
    if (isnan(a_minus_b) || is_told(given, LAC_A) == is_told(given, LAC_B)) {
        return NULL;
    }
    p->a = is_told(given, LAC_A) ? p->a : p->b + a_minus_b;
    p->b = is_told(given, LAC_B) ? p->b : p->a - a_minus_b;
    return p->a >= 0 && p->b >= 0 ? NULL
                                  : "a - b of the rock leaves b < 0 beside so small an a, or a < 0 "
                                    "beside so small a b; give both a and b";
}

const char *lac_law_complete(void *params, uint64_t given)
{
    lac_friction_params *p = params;
    double *const at[] = {&p->f0, &p->a, &p->b, &p->dc};
    if (is_told(given, LAC_ROW_ANGLE)) {
        if (is_told(given, LAC_F0)) {
            return "names both f0 and friction_angle, of which one is the tangent of the other";
        }
        p->f0 = tan(p->friction_angle);
        p->friction_angle = NAN;
        given |= UINT64_C(1) << LAC_F0;
    }
    if (p->rock < 0) {
        return NULL;
    }
    const lac_rock *rock = &rocks[p->rock];
    for (int k = LAC_ROCK_F0; k <= LAC_ROCK_DC; k++) {
        const double value = lac_rock_value_of(rock, k).value;
        *at[k] = is_told(given, k) || isnan(value) ? *at[k] : value;
        given |= isnan(value) ? 0 : UINT64_C(1) << k;
    }
    return complete_pair(lac_rock_value_of(rock, LAC_ROCK_A_B).value, given, p);
}
