// What this thread's rays have cost: nodes visited and primitives tested. With packets, what
// the packet walked: the same for its eight threads.

var<private> visit_nodes: u32 = 0u;
var<private> visit_primitives: u32 = 0u;

fn visit_node() {
    visit_nodes += 1u;
}

fn visit_primitive() {
    visit_primitives += 1u;
}
