// The whole program: every command that there is, and the examples of each.
#include "cli/commands.h"

#include <map>

#include "cli/print/print.h"

namespace trilens {
namespace {

void add_examples(Command& command, const std::string& called) {
    command.examples = examples_of(called);
    for (Command& below : command.commands) add_examples(below, called + " " + below.name);
}

}  // namespace

Command make_commands() {
    Command root{.name = "trilens",
                 .summary = "draw what curved mirrors and glass show, by projection, and measure its error"};
    root.commands = render_commands();
    for (Command& command : std::vector<Command>{
             compare_command(), sweep_command(), report_command(), test_command(), project_command(),
             shoot_command(), fit_command(), design_command(), unwrap_command(), map_command(),
             caustic_command(), bake_command(), anamorph_command(), view_command(), scene_command(),
             lens_command(), cad_command(), info_command()})
        root.commands.push_back(std::move(command));
    add_examples(root, root.name);
    return root;
}

// trilens info: the build, its libraries and the machine, for bug reports.

Command info_command() {
    return {.name = "info",
            .summary = "the build, its libraries and the machine",
            .schema = "info",
            .body = [](Console&) { return build_answer(); }};
}

// The examples of every command, for help and manual pages.

std::vector<Example> examples_of(const std::string& called) {
    static const std::map<std::string, std::vector<Example>> kExamples{
        {"trilens",
         {{"trilens scene example mirror-sphere > scene.json", "a scene to start from"},
          {"trilens render scene.json -o mine.exr", "its picture, by projection"},
          {"trilens trace scene.json -o truth.exr", "the same picture, by ray tracing"},
          {"trilens compare truth.exr mine.exr --max displacement_p95=1",
           "how far they are apart, and whether 95 % lie within a pixel"}}},
        {"trilens render",
         {{"trilens render scene.json -n 16 -o mine.exr", "all layers, 16 x 16 facets per face"},
          {"trilens render scene.json -o mine.png --set /cameras/0/yfov=30",
           "the beauty, through another lens"},
          {"trilens render - --format png -o - < scene.json > mine.png", "from one pipe into another"},
          {"trilens render scene.json --pixel 320,240", "how one pixel comes about"},
          {"trilens render scene.json -o caustics.obj", "where rays that leave its optics meet, as surfaces"},
          {"trilens render mine.exr -n 32 -o finer.exr", "again, from the scene that the image carries"}}},
        {"trilens trace",
         {{"trilens trace scene.json -o truth.exr", "the truth: the exact surface, every ray exact"},
          {"trilens trace scene.json --surface facets -o facets.exr", "the rays of render's own facets"}}},
        {"trilens compare",
         {{"trilens compare truth.exr mine.exr -o diff.exr",
           "metrics, a verdict about colours, and the difference"},
          {"trilens compare truth.exr mine.exr --max displacement_p95=0.5 --max lost_percent=1",
           "fail where what is seen moved too far, or is gone"},
          {"trilens compare other.exr mine.exr --ref-layer ViewLayer.Combined",
           "against another program's image"},
          {"trilens compare truth.png mine.png -o diff.png --scale 10",
           "pictures, and ten times their difference"}}},
        {"trilens sweep run",
         {{"trilens sweep run scene.json --over engine=exact,classic --over resolution=1..16:x2 -o "
           "results/two",
           "two engines in one plot"},
          {"trilens sweep run scene.json --over resolution=1..64:x2 -o results/scene",
           "error against resolution, with a report"}}},
        {"trilens sweep submit",
         {{"trilens sweep submit sweep.json -o /shared/results --print | sbatch",
           "a Slurm job array, one run each"}}},
        {"trilens sweep merge",
         {{"trilens sweep merge here/results there/results -o results/all", "join what two machines did"}}},
        {"trilens sweep schema", {{"trilens sweep schema", "what the fields of summary.json mean"}}},
        {"trilens report", {{"trilens report results/scene", "tables, plots and page again"}}},
        {"trilens sweep plan",
         {{"trilens sweep plan scene.json --over resolution=1,2,4 -o results/scene", "what a run would do"}}},
        {"trilens sweep status", {{"trilens sweep status results/scene", "what is done"}}},
        {"trilens sweep report", {{"trilens sweep report results/scene", "tables, plots and page again"}}},
        {"trilens test",
         {{"trilens test tests/render --html report.html", "all tests below a folder, and a page of them"},
          {"trilens test tests/render -k glass --junit results.xml",
           "those with glass in name or tags, for a CI"},
          {"trilens test tests/render/ball --update",
           "make its stored image again, after a change that is meant"}}},
        {"trilens project",
         {{"trilens project scene.json --point 0,1,2", "all images of one world point"},
          {"trilens project scene.json --points points.csv --json", "of many, for a program"}}},
        {"trilens shoot",
         {{"trilens shoot scene.json --pixel 320.5,240.5", "what the ray of the film's middle comes to"},
          {"trilens shoot scene.json --pixels places.csv --path R --events", "where many meet the mirror"}}},
        {"trilens unwrap",
         {{"trilens unwrap ball.json photo.jpg --to equirect:2048x1024 -o panorama.exr",
           "a mirror ball's photograph into a panorama"},
          {"trilens unwrap room.json photo.exr --to floor:1024x1024 -o floor.exr",
           "what it shows of a flat floor, made straight: its bounding rectangle from its front"}}},
        {"trilens map",
         {{"trilens map ball.json --to equirect:4096x2048 -o unwrap.exr",
           "an STMap that unwraps photographs: oiiotool photo.exr --crop 4096x2048+0+0 unwrap.exr --st_warp "
           "-o panorama.exr"},
          {"trilens map dome.json --to fisheye:2048 --proxy sphere:3 --center 0,0,0 -o warp.data",
           "a projector's warp mesh over a mirror ball into a dome"}}},
        {"trilens caustic",
         {{"trilens caustic scene.json --light 0 --onto floor:1024x1024 -o caustic.exr",
           "what a light brings over mirrors and through glass to a flat floor, per pixel of its "
           "rectangle"}}},
        {"trilens bake",
         {{"trilens bake cornell.json -o baked.json", "a scene whose objects keep the light of the room"},
          {"trilens bake cornell.json --keep-lights --plot convergence.svg -o baked.json",
           "only what comes after the lights themselves, which go on shining; and how it came to rest"}}},
        {"trilens anamorph",
         {{"trilens anamorph cylinder.json --picture p.png --page page --paper A4 --verify -o page.pdf",
           "a page to print at true scale, and how near the picture is seen"}}},
        {"trilens fit",
         {{"trilens fit scene.json --points pairs.csv --free "
           "/meshes/0/primitive/center,/meshes/0/primitive/radius "
           "-o fitted.json --report fit.html",
           "where the ball is and how large, and how sure that is"}}},
        {"trilens design",
         {{"trilens design --example > wish.json", "a wish to start from: a driver's mirror"},
          {"trilens design wish.json -o mirror.json --compare sphere --stl mirror.stl",
           "the mirror as a scene and for a mill, beside the best sphere"}}},
        {"trilens view",
         {{"trilens view scene.json", "a window: drag to orbit, ctrl-click for the path of a pixel"},
          {"trilens view scene.json --script steps.json --screenshot view.png",
           "the same without a window"}}},
        {"trilens scene validate", {{"trilens scene validate scene.json", "before long work"}}},
        {"trilens scene info", {{"trilens scene info scene.json", "cameras, optics, triangles, bounds"}}},
        {"trilens scene schema",
         {{"trilens scene schema > schema.json", "for an editor that checks as you type"}}},
        {"trilens scene example",
         {{"trilens scene example", "their names"},
          {"trilens scene example mirror-sphere > scene.json", "one of them, to start from"}}},
        {"trilens cad",
         {{"trilens cad mirror.step -o mirror.json", "its bodies as mirrors on a floor, in a scene"},
          {"trilens cad mount.step --mirror 'M*' --glass 'lens*' -o mount.json",
           "some bodies as mirrors and glass, the others as objects"}}},
        {"trilens lens",
         {{"trilens lens triplet.zmx --field 12", "focal length, pupils, Seidel sums, the spot"},
          {"trilens lens triplet.zmx --field 12 --line F --rings 20 -o spot.csv", "where blue rays fall"}}},
        {"trilens info", {{"trilens info", "for a report of a problem"}}}};
    const auto found = kExamples.find(called);
    return found == kExamples.end() ? std::vector<Example>{} : found->second;
}

}  // namespace trilens
