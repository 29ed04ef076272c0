// A page that plays runs which it carries.

async function begin() {
    const message = document.getElementById("message");
    if (typeof DecompressionStream === "undefined") {
        message.textContent = "This browser is too old for this page: it cannot unpack the run (DecompressionStream).";
        return;
    }
    try {
        const data = await unpacked("run-data").json();
        document.getElementById("player").hidden = false;
        window.wildfire = new Player(data);
        message.hidden = true;
    } catch (error) {
        message.textContent = `This page cannot play its run: ${error.message}`;
        throw error;
    }
}

begin();
