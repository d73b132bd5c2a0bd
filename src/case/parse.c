// SPDX-License-Identifier: GPL-3.0-or-later
// From YAML to a tree of values, its plain part only: anchors, aliases and tags are refused.
#include <yaml.h>

#include "case/sections.h"

// Nodes being built from the events of libyaml.
typedef struct builder {
    lac_reader *reader;
    const char *place; // of a --set; NULL: a file
    const char *text;  // for the line of a byte
    size_t size;
    lac_node *root;
    lac_node *open[LAC_TREE_DEPTH]; // lists and mappings that have not ended
    size_t depth, nodes;
    char *key; // read, its value awaited
    size_t key_line;
    bool documents_seen;
} builder;

static size_t line_of(const builder *b, const yaml_event_t *event)
{
    return b->place != NULL ? 0 : event->start_mark.line + 1;
}

#define REFUSE(b, event, ...) \
    (lac_add_error_text((b)->reader, line_of(b, event), (b)->place, __VA_ARGS__), false)

static void blame_syntax(builder *b, const yaml_parser_t *parser)
{
    size_t line = parser->problem_mark.line + 1;
    if (parser->error == YAML_MEMORY_ERROR) {
        b->reader->no_memory = true;
    } else if (parser->error == YAML_READER_ERROR) {
        line = 1;
        for (size_t i = 0; i < parser->problem_offset && i < b->size; i++) {
            line += b->text[i] == '\n' ? 1 : 0;
        }
        lac_add_error_text(b->reader, b->place != NULL ? 0 : line, b->place,
                           "is not plain UTF-8 text: %s", parser->problem);
    } else {
        const char *context = parser->context != NULL ? parser->context : "";
        const char *problem = parser->problem != NULL ? parser->problem : "cannot be read";
        lac_add_error_text(b->reader, b->place != NULL ? 0 : line, b->place,
                           "is not valid YAML: %s%s%s", context, context[0] == '\0' ? "" : ", ",
                           problem);
    }
}

// Blames a node; within a --set, its key.
static void blame(builder *b, const lac_node *node, const char *what, const char *name)
{
    if (b->place != NULL) {
        lac_add_error_text(b->reader, 0, b->place, "%s%.60s", what, name);
    } else {
        lac_add_error(b->reader, node, "%s%.60s", what, name);
    }
}

static lac_node *parent_of(const builder *b)
{
    return b->depth == 0 ? NULL : b->open[b->depth - 1];
}

static bool awaits_key(const builder *b)
{
    const lac_node *parent = parent_of(b);
    return parent != NULL && parent->kind == LAC_NODE_MAP && b->key == NULL;
}

static bool take_key(builder *b, const yaml_event_t *event)
{
    const char *text = (const char *)event->data.scalar.value;
    size_t size = event->data.scalar.length;
    if (parent_of(b)->count >= LAC_TREE_KEYS) {
        return REFUSE(b, event, "is no case: a mapping has more than %d keys", LAC_TREE_KEYS);
    }
    if (memchr(text, '\0', size) != NULL) {
        return REFUSE(b, event, "is no case: a key holds a NUL character");
    }
    b->key_line = line_of(b, event);
    b->key = lac_reader_copy(b->reader, text, size);
    return b->key != NULL;
}

static lac_node *add(builder *b, const yaml_event_t *event, lac_node_kind kind, const char *text,
                     size_t size)
{
    lac_node *parent = parent_of(b);
    size_t line = b->key != NULL ? b->key_line : line_of(b, event);
    if (++b->nodes > LAC_TREE_NODES) {
        lac_add_error_text(b->reader, line, b->place, "is no case: it has more than %d values",
                           LAC_TREE_NODES);
        return NULL;
    }
    const lac_node *first = b->key != NULL ? lac_node_child(parent, b->key) : NULL;
    lac_node *node = lac_node_create(parent, kind, b->key, text, size);
    free(b->key);
    b->key = NULL;
    if (node == NULL) {
        b->reader->no_memory = true;
        return NULL;
    }
    node->line = line;
    if (b->root == NULL) {
        b->root = node;
    }
    if (first != NULL) {
        char where[48] = "";
        if (first->line > 0) {
            (void)snprintf(where, sizeof where, ", first on line %zu", first->line);
        }
        blame(b, node, "is given twice", where);
        node->ignored = true;
    }
    return node;
}

static void refuse_marks(builder *b, const lac_node *node, const unsigned char *anchor,
                         const unsigned char *tag)
{
    if (anchor != NULL) {
        blame(b, node, "a case has no anchors such as &", (const char *)anchor);
    }
    if (tag != NULL) {
        blame(b, node, "a case has no tags such as ", (const char *)tag);
    }
}

static bool take_scalar(builder *b, const yaml_event_t *event)
{
    if (awaits_key(b)) {
        return take_key(b, event);
    }
    const char *text = (const char *)event->data.scalar.value;
    size_t size = event->data.scalar.length;
    lac_node *node = add(b, event, LAC_NODE_SCALAR, text, size);
    if (node == NULL) {
        return false;
    }
    node->plain = event->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
    refuse_marks(b, node, event->data.scalar.anchor, event->data.scalar.tag);
    if (strlen(node->text) != size) {
        blame(b, node, "holds a NUL character", "");
        node->bad = true;
    }
    return true;
}

static bool take_alias(builder *b, const yaml_event_t *event)
{
    if (awaits_key(b)) {
        return REFUSE(b, event, "is no case: an alias stands for a key");
    }
    const char *name = (const char *)event->data.alias.anchor;
    lac_node *node = add(b, event, LAC_NODE_SCALAR, "", 0);
    if (node == NULL) {
        return false;
    }
    blame(b, node, "a case has no aliases such as *", name);
    node->bad = true;
    return true;
}

static bool open_node(builder *b, const yaml_event_t *event, lac_node_kind kind)
{
    bool list = kind == LAC_NODE_LIST;
    if (awaits_key(b)) {
        return REFUSE(b, event, "is no case: a key is a %s where it must be a word",
                      list ? "list" : "mapping");
    }
    if (b->depth == LAC_TREE_DEPTH) {
        return REFUSE(b, event, "is no case: it is nested more than %d deep", LAC_TREE_DEPTH);
    }
    lac_node *node = add(b, event, kind, NULL, 0);
    if (node == NULL) {
        return false;
    }
    refuse_marks(b, node,
                 list ? event->data.sequence_start.anchor : event->data.mapping_start.anchor,
                 list ? event->data.sequence_start.tag : event->data.mapping_start.tag);
    b->open[b->depth++] = node;
    return true;
}

static bool take(builder *b, const yaml_event_t *event)
{
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        if (b->documents_seen) {
            return REFUSE(b, event, "holds a second document; a case is one");
        }
        b->documents_seen = true;
        return true;
    case YAML_SCALAR_EVENT:
        return take_scalar(b, event);
    case YAML_ALIAS_EVENT:
        return take_alias(b, event);
    case YAML_SEQUENCE_START_EVENT:
        return open_node(b, event, LAC_NODE_LIST);
    case YAML_MAPPING_START_EVENT:
        return open_node(b, event, LAC_NODE_MAP);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        b->depth--;
        return true;
    case YAML_NO_EVENT:
    case YAML_STREAM_START_EVENT:
    case YAML_STREAM_END_EVENT:
    case YAML_DOCUMENT_END_EVENT:
        break;
    }
    return true;
}

lac_node *lac_tree_parse(lac_reader *reader, const char *text, size_t size, const char *place)
{
    yaml_parser_t parser;
    if (yaml_parser_initialize(&parser) == 0) {
        reader->no_memory = true;
        return NULL;
    }
    builder b = {.reader = reader, .place = place, .text = text, .size = size};
    yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, size);
    bool going = true;
    while (going) {
        yaml_event_t event;
        if (yaml_parser_parse(&parser, &event) == 0) {
            blame_syntax(&b, &parser);
            going = false;
            break;
        }
        bool taken = take(&b, &event);
        bool last = event.type == YAML_STREAM_END_EVENT;
        yaml_event_delete(&event);
        if (last) {
            break;
        }
        going = taken;
    }
    yaml_parser_delete(&parser);
    free(b.key);
    if (!going) {
        lac_node_free(b.root);
        b.root = NULL;
    }
    return b.root;
}
